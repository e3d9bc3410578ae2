# SPDX-License-Identifier: BSD-3-Clause
# cmake -DBUILD=<build folder> -DSOURCE=<this folder> -P run.cmake
# Installs, then finds, builds and runs from outside, compiled with AVX2 where the machine has it.
set(work ${BUILD}/consumer)
file(REMOVE_RECURSE ${work})
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nexit code ${code}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

# Installed where it was configured to be, if that is within the build folder: only there does a program
# anywhere find the shared files without being told.
load_cache(${BUILD} READ_WITH_PREFIX configured_ CMAKE_INSTALL_PREFIX)
string(FIND ${configured_CMAKE_INSTALL_PREFIX} ${BUILD}/ position)
if(position EQUAL 0)
  set(prefix ${configured_CMAKE_INSTALL_PREFIX})
else()
  set(prefix ${work}/prefix)
endif()
file(REMOVE_RECURSE ${prefix})
step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
foreach(name LICENSE NOTICE README.md doc/README.md)
  if(NOT EXISTS ${prefix}/share/doc/dyslam/${name})
    message(FATAL_ERROR "${name} is not installed")
  endif()
endforeach()

set(flags "")
file(READ /proc/cpuinfo cpus)
if(cpus MATCHES "avx2")
  set(flags -mavx2)
endif()
function(build_consumer name components forbidden)
  step(${CMAKE_COMMAND} -G Ninja -S ${SOURCE} -B ${work}/${name} -DCMAKE_PREFIX_PATH=${prefix}
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS=${flags} "-DCOMPONENTS=${components}" "-DFORBIDDEN=${forbidden}")
  step(${CMAKE_COMMAND} --build ${work}/${name})
endfunction()
build_consumer(core "base;core" "Torch;PCL;Ceres;MRPT;OpenCV;octomap;embree")
build_consumer(io io "Torch;Ceres;OpenCV;octomap;embree")
build_consumer(all "" "")

# No header brings in what only sources may use.
step(ninja -C ${work}/all -t deps)
string(REGEX MATCH "[^\n]*/(torch|ATen|c10|pcl[^/]*|ceres)/[^\n]*" leaked "${out}")
if(leaked)
  message(FATAL_ERROR "an installed header includes ${leaked}")
endif()
if(NOT out MATCHES "dyslam/core/Frame.h")
  message(FATAL_ERROR "ninja tells no dependencies: ${out}")
endif()

file(GLOB programs ${work}/all/uses_*)
list(FILTER programs EXCLUDE REGEX "\\.dir$")  # of the precompiled headers
set(told "")
if(NOT position EQUAL 0)
  set(told ${CMAKE_COMMAND} -E env DYSLAM_SHARE=${prefix}/share/dyslam)
endif()
foreach(program ${programs} ${work}/all/example ${work}/all/live)
  step(${CMAKE_COMMAND} -E chdir ${work} ${told} ${program})
endforeach()

# The shared files: where installed, where told, and beside a program that was moved.
if(position EQUAL 0)
  step(${work}/core/uses_base ${prefix}/share/dyslam/)
endif()
file(COPY ${prefix}/share/dyslam DESTINATION ${work}/moved/share)
file(COPY ${work}/core/uses_base DESTINATION ${work}/moved/bin)
step(${work}/moved/bin/uses_base ${work}/moved/share/dyslam/)
step(${CMAKE_COMMAND} -E env DYSLAM_SHARE=${work}/moved/share/dyslam ${work}/core/uses_base
  ${work}/moved/share/dyslam/)
