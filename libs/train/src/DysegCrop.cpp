// SPDX-License-Identifier: BSD-3-Clause
#include "DysegCrop.h"

#include <algorithm>
#include <iterator>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double near_mover_share = 0.85;  // share of crops near a moving object, if there is one
}

Eigen::Vector2f drawCentre(const DysegSample& sample,
                           const BevOptions& grid,
                           const BevOptions& crop,
                           double farthest,
                           RandomDraws& draws)
{
  const float half = crop.halfExtent();
  const float reach = std::min(grid.halfExtent() - half, static_cast<float>(farthest));
  const auto within = [&](float r) { return static_cast<float>(draws.uniform(-r, r)); };
  const float some = 0.8F * reach * static_cast<float>(draws.uniform());
  const float x = within(some);
  const float y = within(some);
  Eigen::Vector2f centre(x, y);
  // No crop contains objects that are farther away.
  std::vector<Eigen::Vector2f> movers;
  std::copy_if(sample.movers.begin(), sample.movers.end(), std::back_inserter(movers),
               [&](const Eigen::Vector2f& m) { return m.cwiseAbs().maxCoeff() < reach + half; });
  if (!movers.empty() && draws.chance(near_mover_share))
  {
    const float spread = 0.7F * half;
    const float dx = within(spread);
    const float dy = within(spread);
    centre = movers[draws.below(movers.size())] + Eigen::Vector2f(dx, dy);
  }
  return centre.cwiseMax(-reach).cwiseMin(reach);
}
}  // namespace dyslam
