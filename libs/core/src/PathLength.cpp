// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/PathLength.h>

namespace dyslam
{
double PathLength::add(const Eigen::Vector3d& position)
{
  if (!position.allFinite())
  {
    return length_;
  }
  const double distance = started_ ? (position - counted_).norm() : 0;
  if (!started_ || distance >= dead_band)
  {
    length_ += distance;
    counted_ = position;
    started_ = true;
  }
  return length_;
}

void PathLength::exchangeState(StateArchive& archive)
{
  archive(length_, counted_, started_);
}
}  // namespace dyslam
