// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/ScanMatcher.h>

#include <string>

namespace dyslam
{
/** Baselines without points: the prior itself, or zero motion. Their information is that of sigmas
 * of 0.1 m and 1 degree. */
class ConstantMotion : public ScanMatcher
{
 public:
  enum class Kind
  {
    constant_velocity,
    zero_motion
  };
  explicit ConstantMotion(Kind kind) : kind_(kind) {}

  [[nodiscard]] ScanMatch match(const Frame& frame, const MotionPrior& prior) override;
  void exchangeState(StateArchive& archive) override { archive(first_); }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] bool onlyPredicts() const override { return kind_ == Kind::constant_velocity; }

 private:
  Kind kind_;
  bool first_ = true;
};
}  // namespace dyslam
