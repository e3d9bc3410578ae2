// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Statistics.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>

namespace dyslam
{
/** Positions x, y of an object's centre in a fixed frame [m], by frame index. */
using PlanarTrack = std::map<int, Eigen::Vector2d>;

/** Predicts an object's next position from its past positions. */
class OneStepPredictor
{
 public:
  virtual ~OneStepPredictor() = default;
  /** Adds an observation; frames in ascending order. */
  virtual void observe(int frame, const Eigen::Vector2d& position) = 0;
  /** Predicted position in `frame`; nothing without a sufficient history. */
  [[nodiscard]] virtual std::optional<Eigen::Vector2d> predict(int frame) const = 0;
};

/** Errors of one-step prediction (the paper's Tables 4 and 5), distances in the plane [m]: after
 * each observation the position in the next frame is predicted and compared with `truth`. The first
 * `warm_up` - 1 observations are not evaluated, nor are frames without truth; gaps in the
 * observations are not bridged. */
[[nodiscard]] Statistics predictionError(OneStepPredictor& predictor,
                                         const PlanarTrack& observations,
                                         const PlanarTrack& truth,
                                         std::size_t warm_up);
}  // namespace dyslam
