// SPDX-License-Identifier: BSD-3-Clause
#include "TrackMarkers.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrackTable.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>

#include "ObjectMarkers.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double same_scan = 1e-3;  //!< [s] between a scan and its pose in odometry_tum.txt
}  // namespace

TrackMarkers::TrackMarkers(const std::string& tracks)
{
  for (LabelledBox& box : readTracks(tracks))
  {
    boxes_[box.frame].push_back(std::move(box));
  }
  const fs::path table = fs::path(tracks).replace_extension(".csv");
  const fs::path odometry = fs::path(tracks).parent_path() / run_files::odometry;
  for (const fs::path& needed : {table, odometry})
  {
    if (!fs::is_regular_file(needed))
    {
      warning_ = tracks + ": " + needed.filename().string() +
                 " of the run is not beside it; the objects are written without velocities";
      return;
    }
  }
  readMotions(table.string());
  odometry_ = readTum(odometry.string());
}

void TrackMarkers::readMotions(const std::string& table)
{
  const TrackTable tracks = readTrackTable(
      table, {TrackValue::frame, TrackValue::id, TrackValue::velocity, TrackValue::dynamic});
  if (!tracks.missing.empty())
  {
    warning_ = table + ": has no column '" + tracks.missing +
               "', as tracks.csv of a run; the objects are written without velocities";
  }
  for (const TrackTableRow& row : tracks.rows)
  {
    motions_[{row.frame, row.id}] = {row.velocity, row.dynamic};
  }
}

std::vector<RosMarker> TrackMarkers::at(std::size_t frame,
                                        double stamp,
                                        const Pose& T_map_vehicle,
                                        const Pose& T_vehicle_lidar) const
{
  const auto found = boxes_.find(static_cast<int>(frame));
  if (found == boxes_.end())
  {
    return {};
  }
  const Pose T_lidar_map = (T_map_vehicle * T_vehicle_lidar).inverse();
  const auto nearest = odometry_.nearest(stamp, same_scan);
  std::vector<RosMarker> markers;
  for (const LabelledBox& object : found->second)
  {
    const Box box = transformedBack(object.box, T_lidar_map);
    const auto known = motions_.find({object.frame, object.id});
    MarkedObject marked{object.id, object.type, box, std::nullopt, false};
    if (known != motions_.end() && nearest)
    {
      const Pose T_map_odom = T_map_vehicle * odometry_[*nearest].pose.inverse();
      marked.velocity = T_map_odom.linear() * known->second.velocity;
      marked.moves = known->second.moves;
    }
    addMarkers(marked, markers);
  }
  return markers;
}
}  // namespace dyslam
