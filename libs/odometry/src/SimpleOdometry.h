// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/StateArchive.h>
#include <dyslam/odometry/ScanMatcher.h>

namespace dyslam
{
/** Least points for the estimate of a motion. */
constexpr std::size_t fewest_points = 30;

/** Why the frame's cloud cannot be used; empty if it can. */
[[nodiscard]] std::string cloudTrouble(const Frame& frame);

/** Baselines that use no points: the prior itself, or zero motion. Their information is that of 0.1
 * m and 1 degree. */
class SimpleOdometry : public ScanMatcher
{
 public:
  enum class Kind
  {
    constant_velocity,
    zero_motion
  };
  explicit SimpleOdometry(Kind kind) : kind_(kind) {}

  [[nodiscard]] ScanMatch match(const Frame& frame, const MotionPrior& prior) override;
  void reset() override { first_ = true; }
  void exchangeState(StateArchive& archive) override { archive(first_); }
  [[nodiscard]] std::string name() const override;

 private:
  Kind kind_;
  bool first_ = true;
};
}  // namespace dyslam
