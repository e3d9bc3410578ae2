// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/RosWriter.h>

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** The tracked objects of a run as shapes to draw: a box, its name and speed, and an arrow as long
 * as the way of a second.
 *
 * Boxes are those of tracks.txt, in the frame of the lidar. Velocities, and whether an object
 * moves, are those of tracks.csv beside it, in the odometry frame, which odometry_tum.txt beside it
 * places in the map; without both files there are boxes and names only. */
class TrackMarkers
{
 public:
  /** \param tracks path of tracks.txt \throws UserError for files that cannot be read. */
  explicit TrackMarkers(const std::string& tracks);

  /** Shapes of the objects at a scan, map frame. \param frame number of the scan in the recording
   * \param stamp of the scan [s] */
  [[nodiscard]] std::vector<RosMarker> at(std::size_t frame,
                                          double stamp,
                                          const Pose& T_map_vehicle,
                                          const Pose& T_vehicle_lidar) const;
  /** Number of boxes at a scan. */
  [[nodiscard]] std::size_t boxes(std::size_t frame) const
  {
    const auto found = boxes_.find(static_cast<int>(frame));
    return found == boxes_.end() ? 0 : found->second.size();
  }
  /** What the files lack, for the user; empty if nothing. */
  [[nodiscard]] const std::string& warning() const { return warning_; }

 private:
  struct Motion
  {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s]
    bool moves = false;
  };

  void readMotions(const std::string& table);

  std::map<int, std::vector<LabelledBox>> boxes_;  //!< by number of the scan; lidar frame
  std::map<std::pair<int, int>, Motion> motions_;  //!< by numbers of scan and object
  Trajectory odometry_;                            //!< T_odom_vehicle; empty: not known
  std::string warning_;
};
}  // namespace dyslam
