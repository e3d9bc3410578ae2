// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>

namespace dyslam
{
/** x, y of an object's centre in a fixed frame [m], by frame number. */
using GroundPath = std::map<int, Eigen::Vector2d>;

/** Says where the object will be next, given where it was seen so far; nothing if it cannot. */
class StepPredictor
{
 public:
  virtual ~StepPredictor() = default;
  /** A sighting, in order of frames. */
  virtual void see(int frame, const Eigen::Vector2d& position) = 0;
  [[nodiscard]] virtual std::optional<Eigen::Vector2d> predict(int frame) const = 0;
};

struct PredictionError
{
  std::size_t predictions = 0;
  double rmse = 0;    //!< root of the mean squared distance in the plane [m]
  double median = 0;  //!< [m]
  double largest = 0;
};

/** One-step prediction as in the paper's Tables 4 and 5: after every sighting the next frame's
 * position is predicted and held against `truth` there. Frames count once `warm_up` sightings were
 * seen; a frame without a sighting is not predicted from, one without truth not counted. */
[[nodiscard]] PredictionError predictionError(StepPredictor& predictor,
                                              const GroundPath& sightings,
                                              const GroundPath& truth,
                                              std::size_t warm_up);
}  // namespace dyslam
