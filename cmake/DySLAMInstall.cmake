# SPDX-License-Identifier: BSD-3-Clause
# Shared files, notices, doc, and what makes find_package(dyslam COMPONENTS ...) work.
# Component `programs`: what users need; `weights`: those for non-commercial use, which no default needs;
# `development`: what programs of their own need beyond it.
set(noncommercial_weights dylo.safetensors dylo.md dyseg.safetensors dyseg.md)
list(TRANSFORM noncommercial_weights REPLACE "(.+)" "PATTERN;\\1;EXCLUDE" OUTPUT_VARIABLE left_out)
install(DIRECTORY share/dyslam DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT programs
  PATTERN training EXCLUDE ${left_out})
list(TRANSFORM noncommercial_weights PREPEND share/dyslam/models/)
install(FILES ${noncommercial_weights} DESTINATION ${CMAKE_INSTALL_DATADIR}/dyslam/models COMPONENT weights)
install(FILES LICENSE NOTICE README.md DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/dyslam COMPONENT programs)
install(DIRECTORY doc DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/dyslam COMPONENT programs)
if(DYSLAM_TRAIN_ONLY)
  return()
endif()

# The package a linked target comes from and, where it is found by components, the component.
function(dyslam_package_of library package component)
  set(${component} "" PARENT_SCOPE)
  if(library MATCHES "^(mrpt::|pcl_|opencv_)(.+)$")
    set(packages "mrpt::" MRPT "pcl_" PCL "opencv_" OpenCV)
    list(FIND packages ${CMAKE_MATCH_1} index)
    math(EXPR index "${index} + 1")
    list(GET packages ${index} found)
    set(${component} ${CMAKE_MATCH_2} PARENT_SCOPE)
  elseif(library MATCHES "^(Eigen3|Ceres|OpenSSL|Threads|ZLIB|TBB|nlohmann_json)::")
    set(found ${CMAKE_MATCH_1})
  elseif(library MATCHES "^(octomap|octomath)$")
    set(found octomap)
  elseif(library STREQUAL "embree")
    set(found embree)
  elseif(library MATCHES "^torch")
    set(found Torch)
  elseif(library MATCHES "^/|^-")
    set(found "")  # a file or a flag
  else()
    message(FATAL_ERROR "${library} is linked by an installed library: name its package in DySLAMInstall.cmake")
  endif()
  set(${package} "${found}" PARENT_SCOPE)
endfunction()

# What each component needs is read from what its target links, so that no second list is kept.
set(DYSLAM_COMPONENT_NEEDS "")
get_property(installed GLOBAL PROPERTY DYSLAM_INSTALLED)
foreach(module IN LISTS installed)
  set(modules)
  set(packages)
  set(package_components)
  get_target_property(libraries dyslam_${module} LINK_LIBRARIES)
  foreach(library IN LISTS libraries)
    if(library MATCHES "^\\$<BUILD_INTERFACE:" OR library MATCHES "^\\$<LINK_ONLY:\\$<BUILD")
      continue()
    endif()
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" library "${library}")
    if(library MATCHES "^dyslam::(.+)$")
      list(APPEND modules ${CMAKE_MATCH_1})
      continue()
    endif()
    dyslam_package_of(${library} package component)
    list(APPEND packages ${package})
    if(component)
      list(APPEND package_components ${package}/${component})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  string(APPEND DYSLAM_COMPONENT_NEEDS
    "set(_dyslam_${module}_modules ${modules})\n"
    "set(_dyslam_${module}_packages ${packages})\n"
    "set(_dyslam_${module}_package_components ${package_components})\n")
endforeach()
set(DYSLAM_COMPONENTS ${installed})

include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dyslam)
set(DYSLAM_SHARE_DIR ${CMAKE_INSTALL_DATADIR}/dyslam)
install(EXPORT dyslamTargets NAMESPACE dyslam:: DESTINATION ${config_dir} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/dyslam-config.cmake.in
  ${CMAKE_BINARY_DIR}/dyslam-config.cmake INSTALL_DESTINATION ${config_dir} PATH_VARS DYSLAM_SHARE_DIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/dyslam-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/dyslam-config.cmake ${CMAKE_BINARY_DIR}/dyslam-config-version.cmake
  DESTINATION ${config_dir} COMPONENT development)
