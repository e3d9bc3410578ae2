// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/odometry/ScanMatcher.h>

#include <cstdint>
#include <memory>
#include <string>

namespace dyslam
{
/** Initial guess of DyLO. */
enum class DyloStart : std::uint8_t
{
  standing,   //!< zero motion, as in the paper: independent of the prior
  prediction  //!< the predicted motion
};

/** Ini section `[dylo]`. */
struct DyloOptions : Options
{
  std::string weights = "dylo.safetensors";  //!< file, or name of weights shipped with DySLAM
  DyloStart start = DyloStart::prediction;
  int threads = 0;         //!< threads of the network; 0: those of the stages
  bool prior = true;       //!< fuse the motion prior, if it has an information
  bool deskew = true;      //!< deskew with the estimated motion, not only with the predicted one
  bool confidence = true;  //!< output the static confidence of each point
  double points_per_measurement = 24;  //!< number of sampled points that count as one measurement
  double min_inlier_share = 0.55;      //!< share of inliers below which the match has failed
  double max_last_step = 0.3;  //!< length of the last step above which the match has failed [m]
  double max_translation = 6;  //!< largest plausible translation between two scans [m]
  /** Largest plausible rotation between two scans [rad]. */
  double max_rotation = 34.4 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};

/** Makes the matcher of learned odometry (DyLO): motion, its information and the static confidence
 * of every point, by a trained network.
 *
 * In the library dyslam::odometry_dylo; makeScanMatcher() loads it with the module `networks`.
 * \throws UserError if the weights cannot be used. */
[[nodiscard]] std::unique_ptr<ScanMatcher> makeDyloMatcher(const DyloOptions& options);

/** dyslam_make_dylo_matcher() of the module `networks`; the caller owns the matcher. */
using MakeDyloMatcher = ScanMatcher*(const DyloOptions&);
}  // namespace dyslam
