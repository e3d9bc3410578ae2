// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

namespace dyslam
{
/** Network shape, ini section `[network]` of DySeg's training. Weights load only into the shape
 * they were trained for. */
struct DysegNetworkOptions : Options
{
  int pillar_channels = 16;    //!< channels of the point features that are pooled per cell
  int half_channels = 24;      //!< feature channels at 1/2 of the grid's resolution
  int quarter_channels = 48;   //!< feature channels at 1/4 and 1/8
  int matching_channels = 32;  //!< channels of the matching features at 1/4 and 1/8
  int fine_channels = 16;      //!< channels of the matching features at 1/2
  int hidden = 24;             //!< channels of the hidden state of the flow update
  int radius = 5;              //!< radius of the correlation windows at 1/4 and 1/8 [cells]
  int fine_radius = 2;         //!< radius of the correlation windows at 1/2 [cells]

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
