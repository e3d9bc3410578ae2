// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloOptions.h>

namespace dyslam
{
void DyloNetworkOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "mask", mask,
      {{"none", DyloMask::none}, {"lonet", DyloMask::lonet}, {"attention", DyloMask::attention}},
      "how moving points are kept out");
  visitor.choice("head", head,
                 {{"regression", DyloHead::regression}, {"gauss_newton", DyloHead::gauss_newton}},
                 "how the pose is found");
  visitor.real("width", width, 0.125, 4, "of the layers, 1 = the paper's");
  visitor.integer("fine_passes", fine_passes, 0, 8,
                  "steps against the full-resolution image in training (gauss_newton); 0: never any");
}
}  // namespace dyslam
