# SPDX-License-Identifier: BSD-3-Clause
# Everything from outside is found here, once. Packages: see PACKAGES in scripts/dependencies.sh.
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB 2021 REQUIRED)
find_package(embree 3 QUIET)
find_package(CLI11 2.1 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)

# The networks are built where libtorch is, and OpenMP for their threads.
option(DYSLAM_WITH_TORCH "Build the networks if libtorch is found" ON)
set(DYSLAM_HAVE_TORCH OFF)
if(DYSLAM_WITH_TORCH)
  find_package(Torch QUIET)
  find_package(OpenMP QUIET COMPONENTS CXX)
  if(Torch_FOUND AND OpenMP_CXX_FOUND)
    set(DYSLAM_HAVE_TORCH ON)
  endif()
endif()
message(STATUS "Networks (libtorch and OpenMP): ${DYSLAM_HAVE_TORCH}")

# Topics of ROS 2 are received and published where Fast DDS is.
option(DYSLAM_WITH_ROS2 "Build the live topics of ROS 2 if Fast DDS is found" ON)
set(DYSLAM_HAVE_FASTDDS OFF)
if(DYSLAM_WITH_ROS2 AND NOT DYSLAM_TRAIN_ONLY AND NOT DYSLAM_FUZZ)
  find_package(fastrtps 2.9 QUIET)
  if(fastrtps_FOUND)
    set(DYSLAM_HAVE_FASTDDS ON)
  endif()
endif()
message(STATUS "Live topics of ROS 2 (Fast DDS): ${DYSLAM_HAVE_FASTDDS}")

if(NOT DYSLAM_TRAIN_ONLY)
  find_package(MRPT 2.5.8 REQUIRED COMPONENTS core config io math poses serialization system obs maps graphs topography opengl
    gui graphslam)
  find_package(Ceres 2.1 REQUIRED)
  find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree search registration)
  find_package(OpenCV 4 REQUIRED COMPONENTS core imgproc imgcodecs)
  find_package(octomap REQUIRED)
  find_package(OpenSSL 3 REQUIRED COMPONENTS Crypto)
endif()

if(DYSLAM_BUILD_TESTS)
  find_package(GTest REQUIRED)
endif()
