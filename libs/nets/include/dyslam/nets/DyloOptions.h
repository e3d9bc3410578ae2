// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

#include <cstdint>

namespace dyslam
{
/** How the dynamic mask is computed (the ablation of the paper's Table 2). */
enum class DyloMask : std::uint8_t
{
  none,      //!< every point weighs the same
  lonet,     //!< per-point MLP on the correlation features alone, as in LO-Net
  attention  //!< spatial and channel attention, the paper's Eq. 1
};

/** How a pose comes from the masked features. */
enum class DyloHead : std::uint8_t
{
  regression,   //!< quaternion and translation from the mask-pooled feature, as in the paper
  gauss_newton  //!< a mask-weighted point-to-plane Gauss-Newton step to soft correspondences
};

/** Shape of the network. Weights fit only the shape they were trained for. */
struct DyloNetworkOptions : Options
{
  DyloMask mask = DyloMask::attention;
  DyloHead head = DyloHead::gauss_newton;
  double width = 0.5;   //!< of the layers, as a share of the full sizes
  /** Gauss-Newton steps against the full-resolution image in training; where nothing is learnt, as
   * many as it takes until a step is short. 0 for none, and no last pass over all points. */
  int fine_passes = 2;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
