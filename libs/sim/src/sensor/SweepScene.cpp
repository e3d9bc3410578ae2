// SPDX-License-Identifier: BSD-3-Clause
#include "SweepScene.h"

namespace dyslam::sim
{
namespace
{
Eigen::Affine3d blend(const Eigen::Affine3d& a, const Eigen::Affine3d& b, double fraction)
{
  Eigen::Affine3d m;
  m.matrix() = (1 - fraction) * a.matrix() + fraction * b.matrix();
  return m;
}
}  // namespace

Eigen::Affine3d PartMotion::at(double fraction) const
{
  return blend(start, end, fraction);
}

Eigen::Affine3d PartMotion::nextAt(double fraction) const
{
  return blend(end, next_end, fraction);
}
}  // namespace dyslam::sim
