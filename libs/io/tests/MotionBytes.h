// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/MotionSamples.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "MrptBytes.h"

namespace dyslam::test
{
/** Another angular velocity for each stamp. */
inline ImuSample imuSample(double stamp)
{
  ImuSample sample;
  sample.stamp = stamp;
  sample.angular_velocity = {0.1, -0.2, std::sin(stamp)};
  sample.T_vehicle_imu = poseFromYpr(0.1, 0.2, 0.3, 1, 0.5, -0.2);
  return sample;
}

/** Angular velocity 0.1, 0.2, 0.3 rad/s. */
inline mrpt::obs::CObservationIMU imuAt(double stamp)
{
  mrpt::obs::CObservationIMU imu;
  imu.timestamp = mrpt::Clock::fromDouble(stamp);
  imu.sensorLabel = "imu";
  imu.set(mrpt::obs::IMU_WX, 0.1);
  imu.set(mrpt::obs::IMU_WY, 0.2);
  imu.set(mrpt::obs::IMU_WZ, 0.3);
  return imu;
}

/** Without velocities. */
inline mrpt::obs::CObservationOdometry odometryAt(double stamp, const mrpt::poses::CPose2D& pose)
{
  mrpt::obs::CObservationOdometry odometry;
  odometry.timestamp = mrpt::Clock::fromDouble(stamp);
  odometry.sensorLabel = "odometry";
  odometry.odometry = pose;
  return odometry;
}

/** A scan of one point. */
inline std::string scanBytes(double stamp)
{
  mrpt::obs::CObservationPointCloud scan;
  scan.timestamp = mrpt::Clock::fromDouble(stamp);
  scan.sensorLabel = "lidar";
  scan.pointcloud = mrpt::maps::CSimplePointsMap::Create();
  scan.pointcloud->insertPoint(1, 2, 3);
  return bytesOf(scan);
}

template <typename Number>
std::string numberBytes(Number value)
{
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/** Length of the header of an object: name and version. */
inline std::size_t headerSize(const std::string& object)
{
  return 2 + (static_cast<unsigned char>(object.at(0)) & 0x7FU);
}

inline std::string withVersion(std::string object, int version)
{
  object.at(headerSize(object) - 1) = static_cast<char>(version);
  return object;
}

/** Where the first value's presence is in an observation of version 4. */
inline std::size_t imuValues(const mrpt::obs::CObservationIMU& imu)
{
  return headerSize(bytesOf(imu)) + bytesOf(imu.sensorPose).size();
}

/** As versions 1 to 3 of MRPT's CObservationIMU, with these counts of flags and values. */
inline std::string olderImu(const mrpt::obs::CObservationIMU& imu,
                            int version,
                            std::uint32_t flags = 31,
                            std::uint32_t values = 31)
{
  std::string bytes = withVersion(bytesOf(imu), version);
  const std::size_t at = imuValues(imu);
  bytes.insert(at + 31 + 8, numberBytes(values));
  bytes.insert(at, numberBytes(flags));
  return bytes;
}

/** As versions 0 and 1 of MRPT's CObservationOdometry; the latter with velocities. */
inline std::string olderOdometry(const mrpt::obs::CObservationOdometry& odometry,
                                 int version,
                                 float speed = 0,
                                 float yaw_rate = 0)
{
  const std::string bytes = withVersion(bytesOf(odometry), version);
  const std::size_t size =
      headerSize(bytes) + bytesOf(odometry.odometry).size() + 4 + odometry.sensorLabel.size() + 8;
  const std::string more = std::string(1, '\0') + numberBytes(std::int32_t{5}) +
                           numberBytes(std::int32_t{6}) + std::string(1, '\x01') +
                           numberBytes(speed) + numberBytes(yaw_rate);
  return bytes.substr(0, size) + (version >= 1 ? more : "") + "\x88";
}
}  // namespace dyslam::test
