// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

#include <cstdint>
#include <string>

namespace dyslam
{
/** Where DyLO's search begins. */
enum class DyloStart : std::uint8_t
{
  standing,   //!< at no motion, as in the paper: the two scans alone decide
  prediction  //!< at the predicted motion
};

/** Ini section `[dylo]`. */
struct DyloOptions : Options
{
  std::string weights = "dylo.safetensors";  //!< file, or name of weights that come with DySLAM
  DyloStart start = DyloStart::prediction;
  int threads = 1;
  bool prior = true;       //!< weigh the prediction against the points, where it has an information
  bool deskew = true;      //!< by the motion found, not only by the predicted one
  bool confidence = true;  //!< hand on how surely each point stands still
  double points_per_measurement = 24;  //!< sampled points that count as one measurement
  double min_inlier_share = 0.55;      //!< with less agreement the match has failed
  double max_last_step = 0.3;          //!< the last pass moves less, or nothing was found [m]
  double max_translation = 6;          //!< farther between two scans is absurd [m]
  double max_rotation = 0.6;           //!< [rad]

  void describe(OptionsVisitor& visitor) override;
};

class ScanMatcher;
/** dyslam_make_dylo_odometry() of the module `networks`; the caller owns the matcher. */
using MakeDyloOdometry = ScanMatcher*(const DyloOptions&);
}  // namespace dyslam
