// SPDX-License-Identifier: BSD-3-Clause
#include "ClearPlaces.h"

#include <dyslam/core/StateArchive.h>

#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t renewal = 5;  // scans
}  // namespace

void ClearPlaces::beginScan(std::size_t scan)
{
  if (scan - begin_ >= renewal)
  {
    std::swap(recent_, older_);
    recent_.clear();
    begin_ = scan;
  }
}

void ClearPlaces::exchangeState(StateArchive& archive)
{
  archive(begin_, recent_, older_);
}
}  // namespace dyslam
