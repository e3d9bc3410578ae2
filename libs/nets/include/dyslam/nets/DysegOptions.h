// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
/** Shape of the DySeg network. Weights fit only the shape they were trained for. */
struct DysegNetworkOptions : Options
{
  int pillar_channels = 16;    //!< of the per-point network that is pooled per cell
  int half_channels = 24;      //!< at half the grid's resolution
  int quarter_channels = 48;   //!< at a quarter of it
  int matching_channels = 32;  //!< compared between scans
  int fine_channels = 16;      //!< compared at half resolution for single points
  int hidden = 24;             //!< state of the recurrent flow update
  int radius = 5;              //!< of the correlation windows [cells]
  int fine_radius = 2;         //!< of the windows at half resolution [cells]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
