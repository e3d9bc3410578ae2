// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/odometry/LidarOdometry.h>

namespace dyslam
{
/** Fewer points than this say nothing about a motion. */
constexpr std::size_t fewest_points = 30;

/** Why the frame's cloud cannot be used; empty if it can. */
[[nodiscard]] std::string cloudTrouble(const Frame& frame);

/** Baselines that look at no points: the prediction itself, or no motion at all. Their information
 * is that of 0.1 m and 1 degree. */
class SimpleOdometry : public LidarOdometry
{
 public:
  enum class Kind
  {
    constant_velocity,
    zero_motion
  };
  explicit SimpleOdometry(Kind kind) : kind_(kind) {}

  MotionEstimate process(const Frame& frame,
                         const Pose& T_previous_current_prediction,
                         const Matrix6& information) override;
  void reset() override { first_ = true; }
  [[nodiscard]] std::string name() const override;

 private:
  Kind kind_;
  bool first_ = true;
};
}  // namespace dyslam
