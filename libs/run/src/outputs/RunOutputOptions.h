// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <map>
#include <string>

namespace dyslam
{
/** Ini section `[output]`: the outputs that a run writes. */
struct RunOutputOptions : Options
{
  /** All outputs are on. */
  RunOutputOptions();
  void describe(OptionsVisitor& visitor) override;

  std::map<std::string, bool> on;  //!< whether an output is on, by RunOutputKind::key
  double scene_voxel_size = 0.4;   //!< side of the cubes with one map point each in the scene [m]
  double checkpoint_seconds = 60;  //!< time between checkpoints [s]; 0: none
};
}  // namespace dyslam
