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
/** Speeds [m/s] by frame and id. */
using TrackSpeeds = std::map<std::pair<int, int>, double>;

/** One true box and what was made of it. */
struct TrackError
{
  int frame = 0;
  int id = -1;
  std::string type;
  double range = 0;    //!< of the true centre from the sensor, in the ground plane [m]
  bool found = false;  //!< the rest says nothing if not
  bool same_type = false;
  double position = 0;          //!< between the centres in the ground plane [m]
  double yaw = 0;               //!< between the axes, 0 to 90 degrees: front and rear alike [rad]
  std::optional<double> speed;  //!< estimated minus true, where both are known [m/s]
};

/** Speeds over ground by central differences of the centres, one-sided at the ends of a track.
 *
 * \param boxes in the lidar frame of their scan. \param T_world_lidar by frame number; boxes at
 * frames without a pose have no speed. */
[[nodiscard]] TrackSpeeds speedsFrom(const std::vector<LabelledBox>& boxes,
                                     const std::map<int, StampedPose>& T_world_lidar);

/** Pairs true and estimated boxes of every frame by their centres' distance in the ground plane:
 * as many pairs as possible up to `max_distance` apart, of least distance in sum.
 *
 * Boxes are in the lidar frame. Reference boxes that `rules` passes over take their estimates with
 * them and are not reported; types only matter for `same_type`.
 */
[[nodiscard]] std::vector<TrackError> trackErrors(const TrackSequence& sequence,
                                                  const TrackRules& rules,
                                                  double max_distance,
                                                  const TrackSpeeds& true_speeds = {},
                                                  const TrackSpeeds& estimated_speeds = {});

/** Averages of the errors of some boxes. */
struct TrackErrorSummary
{
  std::size_t boxes = 0;
  std::size_t found = 0;
  std::size_t same_type = 0;
  double position_mean = 0;   //!< [m]
  double position_rmse = 0;   //!< [m]
  double yaw_median = 0;      //!< [rad]
  std::size_t speeds = 0;     //!< boxes of which both speeds are known
  double speed_mean_abs = 0;  //!< [m/s]
  double speed_bias = 0;      //!< mean of estimated minus true [m/s]
};
/** Of the boxes of one type (any if empty) with a range in [nearest, farthest). */
[[nodiscard]] TrackErrorSummary summaryOf(
    const std::vector<TrackError>& errors,
    const std::string& type = "",
    double nearest = 0,
    double farthest = std::numeric_limits<double>::infinity());
}  // namespace dyslam
