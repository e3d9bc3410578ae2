# SPDX-License-Identifier: BSD-3-Clause
# Debian packages by CPack (scripts/build_packages.sh): `dyslam`, what a user runs and reads,
# `libdyslam-dev`, what programs of one's own are built with, and `dyslam-weights-noncommercial`.
# Man pages and completion come from --help.
option(DYSLAM_HELP_PAGES "Make man pages and bash completion from --help; needs help2man" OFF)
set(share ${CMAKE_INSTALL_DATADIR})
file(READ ${CMAKE_SOURCE_DIR}/LICENSE licence)
file(READ ${CMAKE_SOURCE_DIR}/NOTICE notice)

if(DYSLAM_HELP_PAGES)
  find_program(DYSLAM_HELP2MAN help2man REQUIRED)
  set(pages ${CMAKE_BINARY_DIR}/help_pages)
  get_property(apps GLOBAL PROPERTY DYSLAM_APPS)
  set(stamps)
  foreach(app IN LISTS apps)
    add_custom_command(OUTPUT ${pages}/${app}.stamp
      COMMAND ${CMAKE_SOURCE_DIR}/scripts/help_pages.sh $<TARGET_FILE:${app}> ${pages}
      COMMAND ${CMAKE_COMMAND} -E touch ${pages}/${app}.stamp
      DEPENDS ${app} ${CMAKE_SOURCE_DIR}/scripts/help_pages.sh VERBATIM)
    list(APPEND stamps ${pages}/${app}.stamp)
  endforeach()
  add_custom_target(help_pages ALL DEPENDS ${stamps})
  install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT programs)
  install(DIRECTORY ${pages}/completions/ DESTINATION ${share}/bash-completion/completions COMPONENT programs)
endif()

set(CPACK_GENERATOR DEB)
set(DYSLAM_MAINTAINER "DySLAM authors <dyslam@dyslam.invalid>" CACHE STRING
  "Maintainer named in the packages")
set(CPACK_PACKAGE_CONTACT ${DYSLAM_MAINTAINER})
set(CPACK_PACKAGE_VENDOR "DySLAM")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL programs weights development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME dyslam)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "dyslam-weights-noncommercial, mrpt-apps, slurm-client")
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "DySLAM replays a recording of 3D LiDAR scans, segments the moving points,
estimates the ego-motion, tracks the moving objects, optimises ego-motion and
objects in one factor graph, and writes a clean static map.

This package has the programs, the settings, the default weights (trained on
simulated scans alone), the documentation and two short recordings.")
set(CPACK_DEBIAN_WEIGHTS_PACKAGE_NAME dyslam-weights-noncommercial)
set(CPACK_DEBIAN_WEIGHTS_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_WEIGHTS_PACKAGE_SECTION non-free/science)
set(CPACK_DEBIAN_WEIGHTS_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_WEIGHTS_DESCRIPTION "Weights of DySLAM for non-commercial use only: those of its odometry network
DyLO, and a second set of its segmentation network DySeg. They were trained in
part on KITTI and other recordings; the copyright file names all.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libdyslam-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "dyslam (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), \
libceres-dev, libdeflate-dev, libeigen3-dev, libembree-dev, libisal-dev, liblz4-dev, libmrpt-dev, liboctomap-dev, libopencv-dev, libpcap-dev, \
libpcl-dev, libsqlite3-dev, libssl-dev, libtbb-dev, libtorch-dev, libzstd-dev, libbz2-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "Headers, static libraries and the CMake package of DySLAM, which replays
recordings of 3D LiDAR scans: find_package(dyslam COMPONENTS odometry io).")

install(DIRECTORY ${CMAKE_SOURCE_DIR}/rawlog/ DESTINATION ${share}/doc/dyslam/examples COMPONENT programs EXCLUDE_FROM_ALL)

# What Debian wants of every package: copyright and changelog.
string(TIMESTAMP today "%a, %d %b %Y %H:%M:%S +0000" UTC)
foreach(component programs weights development)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  file(WRITE ${CMAKE_BINARY_DIR}/debian/${package}/changelog.Debian
    "${package} (${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium\n\n"
    "  * See changelog.gz.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${today}\n")
  file(WRITE ${CMAKE_BINARY_DIR}/debian/${package}/copyright "DySLAM ${PROJECT_VERSION}\n\n${licence}\n${notice}")
  configure_file(${CMAKE_SOURCE_DIR}/CHANGELOG.md ${CMAKE_BINARY_DIR}/debian/${package}/changelog COPYONLY)
  execute_process(COMMAND gzip -9nf changelog changelog.Debian
    WORKING_DIRECTORY ${CMAKE_BINARY_DIR}/debian/${package})
  install(DIRECTORY ${CMAKE_BINARY_DIR}/debian/${package}/ DESTINATION ${share}/doc/${package}
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
