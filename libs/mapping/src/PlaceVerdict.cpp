// SPDX-License-Identifier: BSD-3-Clause
#include "PlaceVerdict.h"

#include <algorithm>

namespace dyslam
{
void discount(PlaceEvidence& evidence, float false_free)
{
  constexpr float safety = 1.0F;
  const float expected = safety * false_free;
  const auto beyond = [=](float share)
  { return std::max(0.0F, share - expected) / (1 - expected); };
  evidence.free = beyond(evidence.free);
  evidence.free_near = beyond(evidence.free_near);
}

float movingScore(const PlaceFacts& f)
{
  // The weights of a logistic regression, see doc/mapping.md for what it was fitted to.
  constexpr float a_little = 0.1F;  // of the rays: places of static things are hardly ever free
  const auto little = [=](float share) { return std::min(share, a_little) / a_little; };
  float score = -7.2F;
  score += 1.25F * f.own.probability + 2.7F * f.around.probability + 0.8F * f.around.tracked;
  score += 2.5F * f.around.free + 2.2F * little(f.around.free) - 0.2F * f.around.free_near;
  score += -0.4F * std::min(f.around.free_before, f.around.free_after);
  score += -3.1F * std::min(f.segment_low, 3.0F) / 3 - 0.7F * std::min(f.height, 4.0F) / 4;
  score += f.places < 12 ? -0.4F : 0.0F;
  // What is no larger than a vehicle moves as a whole.
  if (f.length < 20 && f.segment_height < 5)
  {
    score += 1.8F + 0.9F * f.segment.probability + 0.7F * f.segment.tracked;
    score += 2.2F * f.segment.free + 1.9F * little(f.segment.free);
  }
  else
  {
    // Things stand close: where rays are doubtful, the neighbours have to do for the segment.
    score += f.doubt * (2.4F + 1.2F * f.around.probability + 0.7F * f.around.tracked);
  }
  return score;
}
}  // namespace dyslam
