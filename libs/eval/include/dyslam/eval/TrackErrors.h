// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Trajectory.h>
#include <dyslam/eval/TrackMetrics.h>

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Speeds of objects [m/s] by (frame, id). */
using TrackSpeeds = std::map<std::pair<int, int>, double>;

/** One true box and the errors of the estimated box matched to it. */
struct TrackError
{
  int frame = 0;
  int id = -1;             //!< of the true box
  std::string type;        //!< of the true box
  double range = 0;        //!< horizontal distance of the true centre from the sensor [m]
  bool found = false;      //!< matched; the other fields are valid only then
  bool same_type = false;  //!< the two boxes are of one type
  double position = 0;     //!< horizontal distance of the centres [m]
  /** Angle between the axes, in [0, pi/2]: front and rear are not distinguished [rad]. */
  double yaw = 0;
  std::optional<double> speed;  //!< estimated minus true, if both are known [m/s]
};

/** Speeds over ground by central differences of the centres, one-sided at the ends of a track.
 *
 * \param boxes in the lidar frame of their scan \param T_world_lidar poses by frame index; boxes in
 * frames without a pose have no speed. */
[[nodiscard]] TrackSpeeds speedsFrom(const std::vector<LabelledBox>& boxes,
                                     const std::map<int, StampedPose>& T_world_lidar);

/** Centres of objects by frame index, in the lidar frame of the scan [m]. */
using CentresByFrame = std::map<int, std::vector<Eigen::Vector3d>>;

/** Where the objects were in the frames in which they have no box, although they have one before
 * and one later: on the line between these two, by time.
 *
 * \param boxes in the lidar frame of their scan \param T_world_lidar poses by frame index; frames
 * without a pose are left out. */
[[nodiscard]] CentresByFrame hiddenCentres(const std::vector<LabelledBox>& boxes,
                                           const std::map<int, StampedPose>& T_world_lidar);

/** Matches true and estimated boxes of each frame by the horizontal distance of their centres: as
 * many pairs as possible up to `max_distance` [m], with the least sum of distances.
 *
 * Boxes are in the lidar frame. Reference boxes ignored by `rules`, and the estimates matched to
 * them, are not reported; types are only compared for `same_type`.
 */
[[nodiscard]] std::vector<TrackError> trackErrors(const TrackSequence& sequence,
                                                  const TrackRules& rules,
                                                  double max_distance,
                                                  const TrackSpeeds& true_speeds = {},
                                                  const TrackSpeeds& estimated_speeds = {});

/** Averages over the errors of a set of boxes; NaN where there is nothing to average. */
struct TrackErrorSummary
{
  std::size_t boxes = 0;      //!< true boxes
  std::size_t found = 0;      //!< of these, matched
  std::size_t same_type = 0;  //!< of these, with the same type
  double position_mean = 0;   //!< horizontal distance of the centres [m]
  double position_rmse = 0;   //!< of the same distances [m]
  double yaw_median = 0;      //!< angle between the axes [rad]
  std::size_t speeds = 0;     //!< boxes with both speeds known
  double speed_mean_abs = 0;  //!< mean of |estimated minus true| [m/s]
  double speed_bias = 0;      //!< mean of estimated minus true [m/s]
};
/** Averages over boxes of one type (empty: all) with a range in [min_range, max_range) [m]. */
[[nodiscard]] TrackErrorSummary summaryOf(
    const std::vector<TrackError>& errors,
    const std::string& type = "",
    double min_range = 0,
    double max_range = std::numeric_limits<double>::infinity());
}  // namespace dyslam
