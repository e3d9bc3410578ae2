// SPDX-License-Identifier: BSD-3-Clause
#include "TrackMarkers.h"

#include <dyslam/base/Printable.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrackTable.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <optional>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double same_scan = 1e-3;     //!< [s] between a scan and its pose in odometry_tum.txt
constexpr double slowest_arrow = 0.2;  //!< below it the direction is mostly noise [m/s]

RosMarker boxMarker(const LabelledBox& object, const Box& box, bool moves)
{
  RosMarker marker;
  marker.group = "boxes";
  marker.id = object.id;
  marker.pose = poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z(), box.yaw, 0, 0);
  marker.scale = box.size;
  marker.colour = moves ? std::array<float, 4>{1.0F, 0.45F, 0.1F, 0.5F}
                        : std::array<float, 4>{0.55F, 0.6F, 0.65F, 0.4F};
  return marker;
}

RosMarker nameMarker(const LabelledBox& object, const Box& box, const std::optional<double>& speed)
{
  constexpr double letters = 0.6;  // height [m]
  RosMarker marker;
  marker.group = "names";
  marker.id = object.id;
  marker.shape = RosMarker::Shape::text;
  marker.pose.translation() =
      box.centre + (0.5 * box.size.z() + letters) * Eigen::Vector3d::UnitZ();
  marker.scale.setConstant(letters);
  marker.text =
      std::to_string(object.id) + " " + object.type + (speed ? formatted(" %.1f m/s", *speed) : "");
  return marker;
}

/** An arrow along the way of one second. \param velocity map frame [m/s] */
RosMarker arrowMarker(const LabelledBox& object, const Box& box, const Eigen::Vector3d& velocity)
{
  RosMarker marker;
  marker.group = "velocities";
  marker.id = object.id;
  marker.shape = RosMarker::Shape::arrow;
  marker.scale = {0.15, 0.4, 0.5};  // diameters of shaft and head, length of the head
  marker.colour = {1.0F, 0.85F, 0.1F, 1.0F};
  marker.points = {box.centre, box.centre + velocity};
  return marker;
}
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
    std::optional<double> speed;
    bool moves = false;
    if (known != motions_.end() && nearest)
    {
      const Pose T_map_odom = T_map_vehicle * odometry_[*nearest].pose.inverse();
      const Eigen::Vector3d velocity = T_map_odom.linear() * known->second.velocity;
      speed = velocity.norm();
      moves = known->second.moves;
      if (moves && *speed > slowest_arrow)
      {
        markers.push_back(arrowMarker(object, box, velocity));
      }
    }
    markers.push_back(boxMarker(object, box, moves));
    markers.push_back(nameMarker(object, box, speed));
  }
  return markers;
}
}  // namespace dyslam
