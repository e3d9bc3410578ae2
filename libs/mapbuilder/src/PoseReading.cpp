// SPDX-License-Identifier: BSD-3-Clause
#include "PoseReading.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/ScanReading.h>

#include <optional>
#include <utility>
#include <vector>

namespace dyslam
{
namespace
{
/** Poses of KITTI with the times of the scans they are of. */
Trajectory withScanTimes(const Trajectory& poses,
                         const RecordingOnTrajectory& recording,
                         MapListener& listener)
{
  RawlogSourceOptions everything = recording.source;
  static_cast<ScanRange&>(everything) = ScanRange();
  everything.merge_further = false;
  RawlogSource source(recording.rawlog, everything);
  std::vector<std::pair<std::size_t, double>> scans;  // number in the file and time, to be used
  ScanSelection selection(recording.source);
  const auto limit = static_cast<std::size_t>(recording.source.only_first_n);
  (void)readScans(
      source, "times", listener,
      [&](const Frame& frame)
      {
        if (selection.takes(frame.index, frame.scan.stamp) && (limit == 0 || scans.size() < limit))
        {
          scans.emplace_back(frame.index, frame.scan.stamp);
        }
      });
  const std::size_t in_file = source.framesRead() + source.framesDropped();
  if (poses.size() != scans.size() && poses.size() != in_file)
  {
    throw UserError(recording.trajectory + ": has " + counted(poses.size(), "pose") + ", but " +
                    counted(scans.size(), "scan") + (scans.size() == 1 ? " is" : " are") +
                    " used and " + recording.rawlog + " has " + std::to_string(in_file) +
                    "; give the run's --skip-first-n, --only-first-n, --start and --end, or its "
                    "trajectory_tum.txt");
  }
  Trajectory timed;
  for (std::size_t i = 0; i < scans.size(); ++i)
  {
    timed.push_back(scans[i].second, poses[poses.size() == scans.size() ? i : scans[i].first].pose);
  }
  return timed;
}

/** Poses of the lidar to those of the vehicle, by the mounting that the first scan states. */
void toVehicle(Trajectory& poses, const RecordingOnTrajectory& recording)
{
  RawlogSource source(recording.rawlog, recording.source);
  const auto frame = source.next();
  const Pose T_lidar_vehicle = frame ? frame->scan.T_vehicle_lidar.inverse() : Pose::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    poses[i].pose = poses[i].pose * T_lidar_vehicle;
  }
}
}  // namespace

Trajectory readPoses(const RecordingOnTrajectory& recording, MapListener& listener)
{
  auto file = readTrajectory(recording.trajectory);
  const bool timed = file.format == TrajectoryFormat::tum;
  if (!timed && recording.time_offset != 0)
  {
    throw UserError(recording.trajectory +
                    ": has no time stamps; --time-offset is for poses that have them (TUM)");
  }
  Trajectory poses =
      timed ? std::move(file.trajectory) : withScanTimes(file.trajectory, recording, listener);
  for (std::size_t i = 0; timed && i < poses.size(); ++i)
  {
    poses[i].stamp += recording.time_offset;
  }
  if (recording.of_lidar)
  {
    toVehicle(poses, recording);
    return poses;
  }
  return recording.source.levelling().levelled(std::move(poses));
}
}  // namespace dyslam
