// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/RunScans.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace dyslam::test
{
inline constexpr double start_time = 1000;  // of recordings [s]
inline constexpr double period = 0.1;       // between scans [s]

/** A scan of the ground and two walls along x, from a lidar 1.7 m above the vehicle's origin.
 * \param movers points that are appended, map frame */
inline Scan scanFrom(const Pose& T_map_vehicle,
                     double stamp,
                     const std::vector<Eigen::Vector3d>& movers = {})
{
  Scan scan;
  scan.stamp = stamp;
  scan.T_vehicle_lidar.translation().z() = 1.7;
  const Pose T_lidar_map = (T_map_vehicle * scan.T_vehicle_lidar).inverse();
  const auto add = [&](const Eigen::Vector3d& p)
  {
    scan.points.push_back((T_lidar_map * p).cast<float>());
    scan.intensity.push_back(0.5F);
  };
  const double at = T_map_vehicle.translation().x();
  for (double x = std::floor(at) - 12.45; x < at + 12; x += 0.5)
  {
    for (double y = -5.95; y < 6; y += 0.5)
    {
      add({x, y, 0.05});
    }
    for (double z = 0.55; z < 3; z += 0.5)
    {
      add({x, 6.05, z});
      add({x, -6.05, z});
    }
  }
  for (const auto& p : movers)
  {
    add(p);
  }
  return scan;
}

inline Frame frameFrom(const Pose& T_map_vehicle,
                       std::size_t index,
                       const std::vector<Eigen::Vector3d>& movers = {})
{
  Frame frame;
  frame.index = index;
  frame.scan = scanFrom(T_map_vehicle, start_time + period * static_cast<double>(index), movers);
  return frame;
}

/** `count` poses along x, `step` apart [m], from `start` on. */
inline Trajectory straightDrive(std::size_t count, double step, double start = 0)
{
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i)
  {
    const double x = start + step * static_cast<double>(i);
    trajectory.push_back(start_time + period * static_cast<double>(i),
                         poseFromYpr(x, 0, 0, 0, 0, 0));
  }
  return trajectory;
}

/** A recording of the scans along a trajectory, with its poses as ground truth. */
inline void writeRecording(const std::string& path, const Trajectory& trajectory)
{
  RawlogWriter writer(path);
  for (const auto& [stamp, pose] : trajectory)
  {
    writer.write(scanFrom(pose, stamp), pose);
  }
  writer.close();
}

/** Scans as they are recorded: nothing is deskewed. */
inline RunScansOptions asRecorded()
{
  RunScansOptions options;
  options.preprocess.deskew = DeskewMode::none;
  return options;
}

/** Keeps what it is told, a line each. */
class RecordingListener : public MapListener
{
 public:
  void beginReading(const std::string& purpose) override { log.push_back("reading " + purpose); }
  void beginWriting(const std::string& names, const std::string& unit) override
  {
    log.push_back("writing " + names + ", " + unit);
  }
  void update(double fraction, std::size_t count) override
  {
    in_range = in_range && fraction >= 0 && fraction <= 1;
    last_count = count;
    if (!log.empty() && log.back() == stop_at)
    {
      throw MapStopped("stopped");
    }
  }
  void finish(std::size_t count) override { log.push_back("finished " + std::to_string(count)); }
  void warn(const std::string& text) override { warnings.push_back(text); }

  std::vector<std::string> log;
  std::vector<std::string> warnings;
  std::size_t last_count = 0;
  bool in_range = true;
  std::string stop_at;  //!< line of the log after which the work is stopped; empty: none
};
}  // namespace dyslam::test
