// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <string>

namespace dyslam
{
/** Ini section `[boxes]`: boxes that another program detected, used instead of Detector. */
struct GivenBoxesOptions : Options
{
  std::string file;   //!< boxes: one file, or a folder with a file per scan; empty: none
  std::string calib;  //!< KITTI's calibration, for boxes in the camera frame; empty: lidar frame
  double min_score = -1e6;  //!< boxes with a lower score are ignored

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
