// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelClassifier.h"

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr float low_segment = 0.8F;  // height below which segments are less likely to move [m]

/** Whether the voxel may be of a vehicle that only one ring of a sensor with 16 hits: distant, in a
 * low segment, and not as high over the ground as most twigs and leaves. */
bool mayBeHitByOneRing(const VoxelFeatures& f)
{
  constexpr float distant = 12;     // range within which several rings hit a vehicle [m]
  constexpr float near_ground = 2;  // height over the ground [m]
  return f.segment_height < low_segment && f.range > distant && f.height < near_ground;
}

/** Whether the voxel is of a fence or guard rail: a straight row, longer than a car and thinner
 * than any vehicle, that rays pass between its bars, but less often than a place that was really
 * free, and that neither track nor causal label call moving. */
bool isFence(const VoxelFeatures& f)
{
  constexpr float shortest = 4.5F;  // [m]
  constexpr float widest = 0.5F;    // [m]
  constexpr float most = 0.5F;  // largest share of free rays, of tracked points, and of the label
  return f.row_length > shortest && f.row_width < widest && f.segment.free < most &&
         f.segment.tracked < most && f.segment.probability < most;
}
}  // namespace

void discount(VoxelEvidence& evidence, float false_free)
{
  evidence.free = std::max(0.0F, evidence.free - false_free) / (1 - false_free);
}

float movingScore(const VoxelFeatures& f)
{
  // The weights of a logistic regression, see doc/labels.md for its training data. The score of
  // what nothing says to move, the limit of the change of segments and what differs where one ring
  // may hit a vehicle were chosen by hand.
  constexpr float a_little = 0.1F;  // share of free rays that static voxels hardly exceed
  constexpr float lost = 0.5F;      // share of the free rays' weight lost where they are doubtful
  const float trust = 1 - lost * f.doubt;
  const auto little = [=](const VoxelEvidence& e)
  { return trust * std::min(e.free, a_little) / a_little; };
  const auto change = [=](const VoxelEvidence& e)
  { return trust * std::max(e.change_before, e.change_after); };
  const bool known = f.own.known > 0;
  const bool one_ring = mayBeHitByOneRing(f);
  // In a busy lane other vehicles hide the change: what counts there is how often it is free.
  constexpr float often = 0.6F;  // share of free rays that is as good as a certain change
  const float change_around =
      one_ring ? trust * std::min(f.segment.free / often, 1.0F) : change(f.around);
  float score = -6.3F;
  score += 1.5F * f.own.probability + 1.0F * f.around.probability + 0.9F * f.around.tracked;
  score += 1.3F * little(f.around) + 2.65F * change_around;
  score += -2.2F * std::min(f.height, 4.0F) / 4;
  score += (f.voxels < 12 ? -0.5F : 0.0F) + (f.segment_height < low_segment ? -2.0F : 0.0F);
  if (one_ring)
  {
    constexpr float row = 6;  // number of voxels that are certainly a row: a vehicle, not a twig
    score += 2.5F * std::min((f.voxels - 1) / (row - 1), 1.0F);
  }
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
  if (isFence(f))
  {
    constexpr float fence = 3;  // whatever the changes of such a row say
    score -= fence;
  }
  return score;
}
}  // namespace dyslam
