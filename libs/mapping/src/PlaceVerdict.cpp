// SPDX-License-Identifier: BSD-3-Clause
#include "PlaceVerdict.h"

#include <algorithm>

namespace dyslam
{
float movingScore(const PlaceFacts& f)
{
  // The weights of a logistic regression on simulated scans of other seeds than any figure, and on
  // the first half of KITTI raw drive 0005 (doc/mapping.md).
  constexpr float a_little = 0.1F;  // of the rays: places of static things are hardly ever free
  const auto little = [=](float share) { return std::min(share, a_little) / a_little; };
  float score = -6.8F;
  score += 1.5F * f.own.probability + 2.7F * f.around.probability;
  score += 1.2F * f.own.free + 3.6F * f.around.free + 2.5F * little(f.around.free);
  score += -1.4F * f.around.free_near + 1.2F * f.around.tracked;
  score += -0.9F * std::min(f.around.free_before, f.around.free_after);
  score += -2.2F * std::min(f.segment_low, 3.0F) / 3 - 0.4F * std::min(f.height, 4.0F) / 4;
  score += f.places < 12 ? -0.5F : 0.0F;
  // What is no larger than a vehicle moves as a whole.
  if (f.length < 20 && f.segment_height < 5)
  {
    score += 1.7F + 0.8F * f.segment.probability + 1.2F * f.segment.tracked;
    score += 3.1F * f.segment.free + 1.6F * little(f.segment.free) - 1.6F * f.segment.free_near;
  }
  return score;
}
}  // namespace dyslam
