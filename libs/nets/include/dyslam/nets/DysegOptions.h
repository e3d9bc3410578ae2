// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
/** Network shape. Weights load only into the shape they were trained for. */
struct DysegNetworkOptions : Options
{
  int pillar_channels = 16;    //!< of the point features that are pooled per cell
  int half_channels = 24;      //!< features at 1/2 of the grid's resolution
  int quarter_channels = 48;   //!< features at 1/4 and 1/8
  int matching_channels = 32;  //!< matching features at 1/4 and 1/8
  int fine_channels = 16;      //!< matching features at 1/2
  int hidden = 24;             //!< state of the recurrent flow update
  int radius = 5;              //!< of the correlation windows [cells]
  int fine_radius = 2;         //!< of the correlation windows at 1/2 [cells]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
