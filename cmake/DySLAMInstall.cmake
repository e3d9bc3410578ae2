# SPDX-License-Identifier: BSD-3-Clause
# Makes find_package(dyslam) work from an installed tree.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/dyslam)
install(EXPORT dyslamTargets NAMESPACE dyslam:: DESTINATION ${config_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/dyslam-config.cmake.in
  ${CMAKE_BINARY_DIR}/dyslam-config.cmake INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/dyslam-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/dyslam-config.cmake ${CMAKE_BINARY_DIR}/dyslam-config-version.cmake
  DESTINATION ${config_dir})
