// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloNetworkOptions.h>

namespace dyslam
{
void DyloNetworkOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "mask", mask,
      {{"none", DyloMask::none}, {"lonet", DyloMask::lonet}, {"attention", DyloMask::attention}},
      "dynamic mask");
  visitor.choice("head", head,
                 {{"regression", DyloHead::regression}, {"gauss_newton", DyloHead::gauss_newton}},
                 "pose head");
  visitor.real("width", width, 0.125, 4, "channel multiplier; 1 for the paper's sizes");
  visitor.integer("fine_passes", fine_passes, 0, 8,
                  "fine stages in training (gauss_newton); 0 for none, also at inference");
}
}  // namespace dyslam
