// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelClassifier.h"

#include <algorithm>

namespace dyslam
{
namespace
{
/** Weights of the terms of the score [log odds]: those of a logistic regression (doc/labels.md has
 * its training data), and three that were chosen by hand. */
namespace weight
{
constexpr float constant = -6.3F;
constexpr float probability = 1.5F;           // causal moving probability of the voxel
constexpr float probability_around = 1.0F;    // that of the voxels around it
constexpr float tracked_around = 0.9F;        // share of points in a track that ever moves
constexpr float free_around = 1.3F;           // some rays passed through
constexpr float change_around = 2.65F;        // free before, or afterwards
constexpr float height = -2.2F;               // at 4 m over the ground
constexpr float small_segment = -0.5F;        // segment of few voxels
constexpr float low_segment = -2.0F;          // segment lower than a person
constexpr float segment = 1.5F;               // segment no larger than a vehicle
constexpr float segment_probability = 0.25F;  // its mean causal moving probability
constexpr float segment_free = 1.75F;         // some rays passed through it
constexpr float segment_change = 2.5F;        // it was free before, or afterwards
// chosen by hand
constexpr float observed_static = -1.0F;  // observed, and nothing says that it moves
constexpr float row_of_one_ring = 2.5F;   // what only one ring hits is a row
constexpr float fence = -3.0F;            // whatever the changes of such a row say
}  // namespace weight

constexpr float low_segment = 0.8F;  // height below which segments are less likely to move [m]
constexpr float few_voxels = 12;     // number of voxels below which they are, too

/** Evidence of rays, as far as free rays can be trusted in this scan. */
class FreeRays
{
 public:
  /** \param doubt VoxelFeatures::doubt */
  explicit FreeRays(float doubt) : trust_(1 - lost * doubt) {}
  [[nodiscard]] float trust() const { return trust_; }
  /** Whether some rays passed, in [0, 1]: 1 from a share that static voxels hardly exceed. */
  [[nodiscard]] float some(const VoxelEvidence& e) const
  {
    constexpr float a_little = 0.1F;
    return trust_ * std::min(e.free, a_little) / a_little;
  }
  /** Confidence in a change, in [0, 1]. */
  [[nodiscard]] float change(const VoxelEvidence& e) const
  {
    return trust_ * std::max(e.change_before, e.change_after);
  }

 private:
  static constexpr float lost = 0.5F;  // share of their weight that doubtful free rays lose
  float trust_;
};

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

/** Whether other scans observed the voxel, and nothing says that it moves. */
bool isObservedStatic(const VoxelFeatures& f, const FreeRays& rays)
{
  return f.own.known > 0 && rays.change(f.own) < 0.05F && f.own.free < 0.3F &&
         f.own.tracked < 0.5F && f.own.probability < 0.5F;
}

/** Causal labels and tracks. */
float labelTerm(const VoxelFeatures& f)
{
  return weight::probability * f.own.probability +
         weight::probability_around * f.around.probability +
         weight::tracked_around * f.around.tracked;
}

/** What rays observed around the voxel. */
float changeTerm(const VoxelFeatures& f, const FreeRays& rays)
{
  // In a busy lane other vehicles hide the change: what counts there is how often it is free.
  constexpr float often = 0.6F;  // share of free rays that is as good as a certain change
  const float change = mayBeHitByOneRing(f) ? rays.trust() * std::min(f.segment.free / often, 1.0F)
                                            : rays.change(f.around);
  return weight::free_around * rays.some(f.around) + weight::change_around * change;
}

/** What rays observed at the segment. Segments no larger than a vehicle move as a whole, unless
 * they consist of two objects, such as a bench and a pedestrian who passes it. */
float segmentTerm(const VoxelFeatures& f, const FreeRays& rays)
{
  constexpr float most_beyond = 0.2F;  // excess of the segment's change over the voxel's
  const float limit =
      f.own.known > 0 ? std::max(rays.change(f.own), rays.change(f.around)) + most_beyond : 1.0F;
  return weight::segment_free * rays.some(f.segment) +
         weight::segment_change * std::min(rays.change(f.segment), limit);
}
}  // namespace

void discount(VoxelEvidence& evidence, float false_free)
{
  evidence.free = std::max(0.0F, evidence.free - false_free) / (1 - false_free);
}

float movingScore(const VoxelFeatures& f)
{
  const FreeRays rays(f.doubt);
  float score = weight::constant;
  score += labelTerm(f);
  score += changeTerm(f, rays);
  score += weight::height * std::min(f.height, 4.0F) / 4;
  score += (f.voxels < few_voxels ? weight::small_segment : 0.0F) +
           (f.segment_height < low_segment ? weight::low_segment : 0.0F);
  if (mayBeHitByOneRing(f))
  {
    constexpr float row = 6;  // number of voxels that are certainly a row: a vehicle, not a twig
    score += weight::row_of_one_ring * std::min((f.voxels - 1) / (row - 1), 1.0F);
  }
  if (isObservedStatic(f, rays))
  {
    score += weight::observed_static;
  }
  if (f.length < vehicle_length && f.segment_height < vehicle_height)
  {
    score += weight::segment + weight::segment_probability * f.segment.probability;
    score += segmentTerm(f, rays);
  }
  if (isFence(f))
  {
    score += weight::fence;
  }
  return score;
}
}  // namespace dyslam
