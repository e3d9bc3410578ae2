// SPDX-License-Identifier: BSD-3-Clause
#include "MovingPointClassifier.h"

#include <dyslam/base/StateArchive.h>

#include <algorithm>
#include <cmath>

#include "GroundHeights.h"
#include "HindsightParameters.h"
#include "Posts.h"
#include "RayHistory.h"
#include "SegmentDivision.h"
#include "VoxelFeatures.h"

namespace dyslam
{
namespace
{
/** Confidence in a change of a voxel, in [0, 1]. \param scans RayCounts::change_before or
 * change_after */
float confidenceOf(std::uint16_t scans)
{
  return std::min(1.0F, static_cast<float>(scans) / hindsight::certain_change);
}

/** Majority vote of a cell's voxels whether the cell moves. */
class CellVote
{
 public:
  void add(float voxel_probability)
  {
    if (voxel_probability > 0.5F)
    {
      moving_sum_ += voxel_probability;
      ++moving_voxels_;
    }
    else
    {
      static_sum_ += voxel_probability;
      ++static_voxels_;
    }
  }
  /** Mean moving probability of the voxels of the majority. */
  [[nodiscard]] float probability() const
  {
    return static_cast<float>(moving_voxels_ > static_voxels_
                                  ? moving_sum_ / moving_voxels_
                                  : static_sum_ / std::max(1, static_voxels_));
  }

 private:
  double moving_sum_ = 0;  //!< sum of the probabilities of moving voxels
  double static_sum_ = 0;  //!< sum of the probabilities of static voxels
  int moving_voxels_ = 0;
  int static_voxels_ = 0;
};

/** Positions of the cloud's points in the odometry frame [m]. */
std::vector<Eigen::Vector3f> positionsOf(const Frame& frame)
{
  const Eigen::Isometry3f T_odom_vehicle = frame.T_odom_vehicle.cast<float>();
  std::vector<Eigen::Vector3f> positions;
  positions.reserve(frame.cloud.size());
  for (const Eigen::Vector3f& p : frame.cloud.points)
  {
    positions.push_back(T_odom_vehicle * p);
  }
  return positions;
}

/** One value per point: 1 if it belongs to a track that is dynamic at any time, else 0. */
std::vector<float> trackedShare(const Frame& frame, const ScanWindow& window)
{
  std::vector<float> tracked(frame.cloud.size(), 0.0F);
  for (const TrackedObject& object : frame.objects)
  {
    if (window.isEverDynamic(object.id))
    {
      for (const std::uint32_t i : frame.pointsOf(object))
      {
        tracked[i] = 1;
      }
    }
  }
  return tracked;
}

/** Evidence of each voxel from the causal labels and the tracks of its points. */
std::vector<VoxelEvidence> causalEvidence(const Frame& frame,
                                          const ScanWindow& window,
                                          const Segments& segments)
{
  std::vector<VoxelEvidence> evidence(segments.first_point.size());
  const std::vector<float> tracked = trackedShare(frame, window);
  std::vector<float> points(evidence.size(), 0.0F);  // number of points of each voxel
  for (std::size_t i = 0; i < segments.voxel_of_point.size(); ++i)
  {
    const std::uint32_t v = segments.voxel_of_point[i];
    if (v != Segments::none)
    {
      points[v] += 1;
      evidence[v].tracked += tracked[i];
      evidence[v].probability +=
          i < frame.moving_probability.size() ? frame.moving_probability[i] : 0.0F;
    }
  }
  for (std::size_t v = 0; v < evidence.size(); ++v)
  {
    evidence[v].tracked /= points[v];
    evidence[v].probability /= points[v];
  }
  return evidence;
}

/** Moving probability of each point: that of its voxel, 0 for points without a voxel. */
std::vector<float> probabilityOfPoints(const Segments& segments,
                                       const std::vector<float>& voxel_probability)
{
  std::vector<float> probability;
  probability.reserve(segments.voxel_of_point.size());
  for (const std::uint32_t v : segments.voxel_of_point)
  {
    probability.push_back(v == Segments::none ? 0 : voxel_probability[v]);
  }
  return probability;
}

/** Highest moving probability of the cells from the one around a point upwards, 0 if there are
 * none. \param p odometry frame [m] */
float probabilityAbove(const Eigen::Vector3f& p,
                       const Segments& segments,
                       const std::vector<CellVote>& votes)
{
  float highest = 0;
  for (int above = 0; above < hindsight::cells_above; ++above)
  {
    const Eigen::Vector3f in_cell =
        p + Eigen::Vector3f(0, 0, static_cast<float>(above) / segments.inverse_cell_size);
    const std::uint32_t cell =
        segments.cell_index.find(voxelKey(voxelCell(in_cell, segments.inverse_cell_size)));
    if (cell != VoxelHash::none)
    {
      highest = std::max(highest, votes[cell].probability());
    }
  }
  return highest;
}
}  // namespace

MovingPointClassifier::MovingPointClassifier(const HindsightOptions& options, int threads)
    : options_(options), pool_(threads)
{
}

void MovingPointClassifier::label(Frame& frame, const ScanWindow& window)
{
  ground_planes_.beginScan(window.number());
  clear_voxels_.beginScan(window.number());
  recent_scores_.beginScan(window.number());
  Points points;
  points.positions = positionsOf(frame);
  ground_planes_.fit(window.lowestReturns(), points.positions);
  points.heights = heightsOverGround(window.lowestReturns(), points.positions, ground_planes_);
  Segments segments = segment(points);
  std::vector<VoxelEvidence> evidence = causalEvidence(frame, window, segments);
  addRayEvidence(frame, window, points, segments, evidence);
  const std::vector<VoxelFeatures> features = featuresOf(frame, points, evidence, segments);
  const std::vector<float> voxel_probability = classify(points, segments, features);
  frame.moving_probability = probabilityOfPoints(segments, voxel_probability);
  labelLowPoints(window, points, segments, voxel_probability, frame.moving_probability);
  decideMoving(frame, options_.moving_threshold);
}

/** Groups the points above `ground_clearance` into voxels and segments; lower points get none. */
Segments MovingPointClassifier::segment(const Points& points) const
{
  std::vector<bool> is_above_ground;
  is_above_ground.reserve(points.heights.size());
  for (const float height : points.heights)
  {
    is_above_ground.push_back(height > static_cast<float>(options_.ground_clearance));
  }
  return findSegments(points.positions, is_above_ground, options_.voxel_size, options_.segment_gap);
}

/** Adds what the rays of the other scans observed. \param[in,out] evidence causal evidence, one
 * value per voxel */
void MovingPointClassifier::addRayEvidence(const Frame& frame,
                                           const ScanWindow& window,
                                           const Points& points,
                                           const Segments& segments,
                                           std::vector<VoxelEvidence>& evidence)
{
  std::vector<std::size_t> evaluated;   // voxels at which rays are evaluated
  std::vector<Eigen::Vector3f> voxels;  // a point of each evaluated voxel, vehicle frame [m]
  std::vector<RayEffort> efforts;
  for (std::size_t v = 0; v < evidence.size(); ++v)
  {
    const bool suspected =
        evidence[v].tracked > 0 || evidence[v].probability > hindsight::suspicious_probability;
    if (!suspected && clear_voxels_.contain(segments.key_of_voxel[v]))
    {
      evidence[v].known = 1;
      continue;
    }
    const std::uint32_t first = segments.first_point[v];
    evaluated.push_back(v);
    voxels.push_back(frame.cloud.points[first]);
    efforts.push_back(suspected                                ? RayEffort::all
                      : points.heights[first] > vehicle_height ? RayEffort::few
                                                               : RayEffort::if_needed);
  }
  const std::vector<RayCounts> counts =
      countRays(window.others(), voxels, efforts, static_cast<float>(0.5 * options_.voxel_size),
                static_cast<float>(options_.margin), pool_);
  for (std::size_t i = 0; i < counts.size(); ++i)
  {
    const RayCounts& c = counts[i];
    VoxelEvidence& e = evidence[evaluated[i]];
    const int known = c.free + c.occupied;
    e.known = known > 0 ? 1.0F : 0.0F;
    e.free = static_cast<float>(c.free) / static_cast<float>(std::max(1, known));
    e.change_before = confidenceOf(c.change_before);
    e.change_after = confidenceOf(c.change_after);
    if (isClear(c))
    {
      clear_voxels_.add(segments.key_of_voxel[evaluated[i]]);
    }
  }
}

/** Features of the voxels. Large segments are divided first, unless rays pass through static
 * objects in this scan: panes of glass and thin structures, which are seen from some directions
 * only, look as if they came and went. \param[in,out] segments may get further segments */
std::vector<VoxelFeatures> MovingPointClassifier::featuresOf(
    const Frame& frame,
    const Points& points,
    const std::vector<VoxelEvidence>& evidence,
    Segments& segments)
{
  const auto features = [&]
  {
    return voxelFeatures(segments, evidence, points.positions, points.heights,
                         frame.T_odom_vehicle.translation().cast<float>());
  };
  std::vector<VoxelFeatures> result = features();
  const bool trusted = !result.empty() && result.front().doubt < hindsight::doubt_of_division;
  if (trusted && divideLargeSegments(evidence, points.positions, segments))
  {
    result = features();
  }
  return result;
}

/** Probability that a voxel's points move, one value per voxel. */
std::vector<float> MovingPointClassifier::classify(const Points& points,
                                                   const Segments& segments,
                                                   const std::vector<VoxelFeatures>& features)
{
  std::vector<Eigen::Vector3f> voxels;  // a point of each voxel, odometry frame [m]
  voxels.reserve(features.size());
  for (const VoxelFeatures& f : features)
  {
    voxels.push_back(points.positions[f.point]);
  }
  const Posts posts(voxels);
  std::vector<float> probability;
  probability.reserve(features.size());
  for (std::size_t v = 0; v < features.size(); ++v)
  {
    float score = movingScore(features[v]);
    if (score > hindsight::doubtful_score && posts.contain(v))
    {
      score -= hindsight::post_score;
    }
    score = recent_scores_.smooth(segments.key_of_voxel[v], score);
    probability.push_back(1 / (1 + std::exp(-score)));
  }
  return probability;
}

/** Labels points above the ground that are in no voxel: they move if the cells above them do.
 * \param[in,out] probability moving probability of each point */
void MovingPointClassifier::labelLowPoints(const ScanWindow& window,
                                           const Points& points,
                                           const Segments& segments,
                                           const std::vector<float>& voxel_probability,
                                           std::vector<float>& probability)
{
  std::vector<CellVote> votes(segments.cells.size());
  for (std::size_t v = 0; v < voxel_probability.size(); ++v)
  {
    votes[segments.cell_of_voxel[v]].add(voxel_probability[v]);
  }
  std::vector<std::uint32_t> low;  // points above the ground of their square of 2 m
  Points low_points;
  for (std::uint32_t i = 0; i < probability.size(); ++i)
  {
    if (segments.voxel_of_point[i] == Segments::none &&
        points.heights[i] > hindsight::lowest_over_square)
    {
      low.push_back(i);
      low_points.positions.push_back(points.positions[i]);
      low_points.heights.push_back(points.heights[i]);
    }
  }
  const std::vector<float> fine =
      fineHeightsOverGround(window.lowestReturns(), low_points.positions, low_points.heights);
  for (std::size_t k = 0; k < low.size(); ++k)
  {
    if (fine[k] > hindsight::lowest_over_fine_square)
    {
      probability[low[k]] = probabilityAbove(low_points.positions[k], segments, votes);
    }
  }
}

void MovingPointClassifier::exchangeState(StateArchive& archive)
{
  archive(ground_planes_, clear_voxels_, recent_scores_);
}
}  // namespace dyslam
