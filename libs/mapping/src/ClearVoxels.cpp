// SPDX-License-Identifier: BSD-3-Clause
#include "ClearVoxels.h"

#include <dyslam/base/StateArchive.h>

#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t renewal = 5;  // scans after which recent voxels become older ones
}  // namespace

void ClearVoxels::beginScan(std::size_t scan)
{
  const std::size_t passed = scan - begin_;
  if (passed >= renewal)
  {
    std::swap(recent_, older_);
    recent_.clear();
    if (passed >= 2 * renewal)
    {
      older_.clear();
    }
    begin_ = scan;
  }
}

void ClearVoxels::exchangeState(StateArchive& archive)
{
  archive(begin_, recent_, older_);
}
}  // namespace dyslam
