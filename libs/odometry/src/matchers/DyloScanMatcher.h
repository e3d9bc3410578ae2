// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/nets/DyloMatcher.h>
#include <dyslam/odometry/Dylo.h>

#include <string>
#include <vector>

#include "ScanToScan.h"

namespace dyslam
{
/** Learned odometry (DyLO): motion, its information and the static confidence of every point. */
class DyloScanMatcher : public ScanToScan
{
 public:
  /** \throws UserError if the weights cannot be used. */
  explicit DyloScanMatcher(const DyloOptions& options);

  [[nodiscard]] std::string name() const override { return "dylo"; }
  [[nodiscard]] bool usesPrior() const override { return options_.prior; }

 private:
  std::string extract(const Frame& frame) override;
  MotionEstimate align(const Pose& T_reference_current_guess) override;
  void accept(const Pose& T_reference_current) override;
  void exchangeReference(StateArchive& archive) override { archive(matcher_); }
  [[nodiscard]] std::vector<float> staticConfidence() const override { return confidence_; }

  [[nodiscard]] std::string doubts(const DyloMatch& match) const;

  DyloOptions options_;
  DyloMatcher matcher_;
  Pose T_vehicle_lidar_ = Pose::Identity();
  std::vector<Eigen::Vector3f> points_;  //!< points of the frame, lidar frame [m]
  std::vector<float> weights_;           //!< weights of the frame's points; empty: 1
  std::vector<float> confidence_;
};
}  // namespace dyslam
