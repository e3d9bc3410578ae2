// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelClassifier.h"

#include <algorithm>

namespace dyslam
{
namespace
{
/** Part of the score that depends on the height of the segment [log odds]. */
float segmentHeightScore(const VoxelFeatures& f)
{
  constexpr float lowest_vehicle = 0.8F;  // height of segments that are seen as a whole [m]
  constexpr float low_score = -2.0F;
  if (f.segment_height >= lowest_vehicle)
  {
    return 0;
  }
  // A distant vehicle may be hit by one ring of a sensor with 16. It is a row of voxels near the
  // ground then; twigs and leaves are smaller or higher.
  constexpr float distant = 12;      // range from which one ring may hit a vehicle [m]
  constexpr float near_ground = 2;   // height over the ground below which most vehicles are [m]
  constexpr float row = 6;           // number of voxels that are certainly a row
  constexpr float row_score = 2.5F;  // score of a row, relative to that of a single voxel
  const bool may_be_row = f.range > distant && f.height < near_ground;
  return low_score + (may_be_row ? row_score * std::min((f.voxels - 1) / (row - 1), 1.0F) : 0.0F);
}
}  // namespace

void discount(VoxelEvidence& evidence, float false_free)
{
  evidence.free = std::max(0.0F, evidence.free - false_free) / (1 - false_free);
}

float movingScore(const VoxelFeatures& f)
{
  // The weights of a logistic regression, see doc/labels.md for its training data. The score of
  // what nothing says to move, the limit of the change of segments and the score of rows were
  // chosen by hand.
  constexpr float a_little = 0.1F;  // share of free rays that static voxels hardly exceed
  constexpr float lost = 0.5F;      // share of the free rays' weight lost where they are doubtful
  const float trust = 1 - lost * f.doubt;
  const auto little = [=](const VoxelEvidence& e)
  { return trust * std::min(e.free, a_little) / a_little; };
  const auto change = [=](const VoxelEvidence& e)
  { return trust * std::max(e.change_before, e.change_after); };
  const bool known = f.own.known > 0;
  float score = -6.3F;
  score += 1.5F * f.own.probability + 1.0F * f.around.probability + 0.9F * f.around.tracked;
  score += 1.3F * little(f.around) + 2.65F * change(f.around);
  score += -2.2F * std::min(f.height, 4.0F) / 4;
  score += (f.voxels < 12 ? -0.5F : 0.0F) + segmentHeightScore(f);
  if (known && change(f.own) < 0.05F && f.own.free < 0.3F && f.own.tracked < 0.5F &&
      f.own.probability < 0.5F)
  {
    score -= 1.0F;  // observed, and nothing says that it moves
  }
  // Segments no larger than a vehicle move as a whole, unless they consist of two objects, such as
  // a bench and a pedestrian who passes it.
  if (f.length < 20 && f.segment_height < vehicle_height)
  {
    constexpr float most_beyond = 0.2F;  // excess of the segment's change over the voxel's
    const float limit = known ? std::max(change(f.own), change(f.around)) + most_beyond : 1.0F;
    score += 1.5F + 0.25F * f.segment.probability;
    score += 1.75F * little(f.segment) + 2.5F * std::min(change(f.segment), limit);
  }
  return score;
}
}  // namespace dyslam
