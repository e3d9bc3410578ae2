// SPDX-License-Identifier: BSD-3-Clause
#include "VoxelFeatures.h"

#include <algorithm>

#include "SegmentShape.h"

namespace dyslam
{
namespace
{
/** Sum of the evidence of several voxels. */
class EvidenceSum
{
 public:
  void add(const VoxelEvidence& e)
  {
    ++count_;
    sum_.known += e.known;
    sum_.free += e.known * e.free;
    sum_.change_before += e.change_before;
    sum_.change_after += e.change_after;
    sum_.probability += e.probability;
    sum_.tracked += e.tracked;
  }
  void add(const EvidenceSum& other)
  {
    count_ += other.count_;
    sum_.known += other.sum_.known;
    sum_.free += other.sum_.free;
    sum_.change_before += other.sum_.change_before;
    sum_.change_after += other.sum_.change_after;
    sum_.probability += other.sum_.probability;
    sum_.tracked += other.sum_.tracked;
  }
  [[nodiscard]] float count() const { return count_; }
  [[nodiscard]] VoxelEvidence mean() const
  {
    const float n = std::max(count_, 1.0F);
    VoxelEvidence e = sum_;
    e.free = sum_.free / std::max(sum_.known, 1e-6F);
    e.known /= n;
    e.change_before /= n;
    e.change_after /= n;
    e.probability /= n;
    e.tracked /= n;
    return e;
  }

 private:
  float count_ = 0;
  VoxelEvidence sum_;
};

/** Share of rays that passed through certainly static voxels, because of thin objects, edges and
 * pose errors. Measured on segments higher than any vehicle; 0 if there are too few. */
float falseFreeShare(const std::vector<VoxelFeatures>& features)
{
  constexpr float surely_static = 0.1F;  // largest mean moving probability around the voxel
  constexpr std::size_t enough = 100;    // number of voxels that is exceeded
  constexpr double highest = 0.3;
  double sum = 0;
  std::size_t count = 0;
  for (const VoxelFeatures& f : features)
  {
    if (f.segment_height > vehicle_height && f.around.probability < surely_static)
    {
      sum += static_cast<double>(f.own.free);
      ++count;
    }
  }
  return count > enough ? static_cast<float>(std::min(highest, sum / static_cast<double>(count)))
                        : 0.0F;
}
}  // namespace

std::vector<VoxelFeatures> voxelFeatures(const Segments& segments,
                                         const std::vector<VoxelEvidence>& evidence,
                                         const std::vector<Eigen::Vector3f>& points,
                                         const std::vector<float>& heights,
                                         const Eigen::Vector3f& vehicle)
{
  std::vector<EvidenceSum> of_cell(segments.cells.size());
  std::vector<EvidenceSum> of_segment(segments.segments);
  for (std::size_t g = 0; g < evidence.size(); ++g)
  {
    of_cell[segments.cell_of_voxel[g]].add(evidence[g]);
    of_segment[segments.segment_of_voxel[g]].add(evidence[g]);
  }
  std::vector<VoxelEvidence> around;
  for (std::uint32_t c = 0; c < of_cell.size(); ++c)
  {
    EvidenceSum sum;
    segments.forEachNeighbour(c, [&](std::uint32_t n) { sum.add(of_cell[n]); });
    around.push_back(sum.mean());
  }
  std::vector<VoxelEvidence> whole;
  for (const EvidenceSum& sum : of_segment)
  {
    whole.push_back(sum.mean());
  }
  const std::vector<SegmentShape> shapes = segmentShapes(segments, points);
  std::vector<VoxelFeatures> features(evidence.size());
  for (std::size_t g = 0; g < evidence.size(); ++g)
  {
    VoxelFeatures& f = features[g];
    const std::uint32_t s = segments.segment_of_voxel[g];
    f.point = segments.first_point[g];
    f.own = evidence[g];
    f.around = around[segments.cell_of_voxel[g]];
    f.segment = whole[s];
    f.height = heights[f.point];
    f.range = (points[f.point] - vehicle).norm();
    f.length = shapes[s].length;
    f.segment_height = shapes[s].height;
    f.row_length = shapes[s].row_length;
    f.row_width = shapes[s].row_width;
    f.voxels = of_segment[s].count();
  }
  const float false_free = falseFreeShare(features);
  constexpr float much = 0.1F;
  for (VoxelFeatures& f : features)
  {
    f.doubt = std::min(1.0F, false_free / much);
    discount(f.own, false_free);
    discount(f.around, false_free);
    discount(f.segment, false_free);
  }
  return features;
}
}  // namespace dyslam
