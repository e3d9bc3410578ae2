# SPDX-License-Identifier: BSD-3-Clause
# cmake -DBUILD=<build folder> -DSOURCE=<this folder> -P run.cmake: install, find, build, run.
set(prefix ${BUILD}/consumer/prefix)
function(step)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${out}")
  endif()
endfunction()
step(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
step(${CMAKE_COMMAND} -S ${SOURCE} -B ${BUILD}/consumer/build -DCMAKE_PREFIX_PATH=${prefix}
  -DCMAKE_BUILD_TYPE=Release)
step(${CMAKE_COMMAND} --build ${BUILD}/consumer/build)
step(${CMAKE_COMMAND} -E chdir ${BUILD}/consumer/build ./consumer)
