// SPDX-License-Identifier: BSD-3-Clause
#include "RecentScores.h"

#include <dyslam/base/StateArchive.h>

#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr float sure = 3;  // log odds, of either sign, from which on a score is not smoothed
constexpr std::size_t longest_gap = 2;  // scans after which scores are forgotten
}  // namespace

void RecentScores::OfScan::exchangeState(StateArchive& archive)
{
  archive(scan, index, scores);
}

void RecentScores::beginScan(std::size_t scan)
{
  std::swap(before_[0], before_[1]);
  std::swap(before_[0], current_);
  current_.scan = scan;
  current_.index.clear();
  current_.scores.clear();
  for (OfScan& before : before_)
  {
    if (scan - before.scan > longest_gap)
    {
      before.index.clear();
    }
  }
}

float RecentScores::smooth(std::uint64_t key, float score)
{
  for (const OfScan& before : before_)
  {
    const std::uint32_t i = before.index.find(key);
    if (i != VoxelHash::none)
    {
      score = std::abs(score) < sure ? 0.5F * (score + before.scores[i]) : score;
      break;
    }
  }
  const auto next = static_cast<std::uint32_t>(current_.scores.size());
  if (current_.index.findOrInsert(key, next) == next)
  {
    current_.scores.push_back(score);
  }
  return score;
}

void RecentScores::exchangeState(StateArchive& archive)
{
  archive(current_, before_[0], before_[1]);
}
}  // namespace dyslam
