// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <cstdint>

namespace dyslam
{
/** The dynamic mask (ablation of the paper's Table 2). */
enum class DyloMask : std::uint8_t
{
  none,      //!< equal weights
  lonet,     //!< per-point MLP on the correlation features alone, as in LO-Net
  attention  //!< spatial and channel attention, the paper's Eq. 1
};

/** Pose head. */
enum class DyloHead : std::uint8_t
{
  regression,   //!< quaternion and translation from the mask-pooled feature, as in the paper
  gauss_newton  //!< a mask-weighted point-to-plane Gauss-Newton step to soft correspondences
};

/** Network shape, ini section `[network]` of DyLO's training. Weights load only into the shape they
 * were trained for. */
struct DyloNetworkOptions : Options
{
  DyloMask mask = DyloMask::attention;
  DyloHead head = DyloHead::gauss_newton;
  double width = 0.5;  //!< channel multiplier; 1 for PWCLO-Net's sizes
  /** Number of fine stages (Gauss-Newton steps on the full-resolution image) in training; at
   * inference, iterations until convergence. 0 for none, and no dense stage. */
  int fine_passes = 2;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
