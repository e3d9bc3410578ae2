// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloNetworkOptions.h>

namespace dyslam
{
void DyloNetworkOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "mask", mask,
      {{"none", DyloMask::none}, {"lonet", DyloMask::lonet}, {"attention", DyloMask::attention}},
      "mask of moving points in the pose estimate");
  visitor.choice("head", head,
                 {{"regression", DyloHead::regression}, {"gauss_newton", DyloHead::gauss_newton}},
                 "pose head: regression, or Gauss-Newton step to soft correspondences");
  visitor.real("width", width, 0.125, 4, "multiplier of the channels; 1: those of PWCLO-Net");
  visitor.integer("fine_passes", fine_passes, 0, 8,
                  "fine stages in training, with head = gauss_newton; 0: none, also at inference");
}
}  // namespace dyslam
