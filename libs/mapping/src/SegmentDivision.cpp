// SPDX-License-Identifier: BSD-3-Clause
#include "SegmentDivision.h"

#include <dyslam/base/DisjointSets.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "SegmentShape.h"

namespace dyslam
{
namespace
{
constexpr float certain_enough = 0.5F;   // least mean confidence that a cell's voxels changed
constexpr std::size_t least_voxels = 8;  // least number of voxels of a part

/** Whether a segment is larger than any vehicle. */
bool isLarge(const SegmentShape& shape)
{
  return shape.length >= vehicle_length || shape.height >= vehicle_height ||
         shape.row_width >= vehicle_width;
}

/** Whether each cell belongs to a large segment and changed. */
std::vector<bool> findChanged(const std::vector<VoxelEvidence>& evidence,
                              const std::vector<SegmentShape>& shapes,
                              const Segments& segments)
{
  std::vector<float> sum(segments.cells.size(), 0.0F);  // confidence in a change, over the voxels
  std::vector<float> count(segments.cells.size(), 0.0F);
  for (std::size_t v = 0; v < evidence.size(); ++v)
  {
    if (isLarge(shapes[segments.segment_of_voxel[v]]))
    {
      const std::uint32_t cell = segments.cell_of_voxel[v];
      sum[cell] += std::max(evidence[v].change_before, evidence[v].change_after);
      count[cell] += 1;
    }
  }
  std::vector<bool> changed;
  changed.reserve(sum.size());
  for (std::size_t c = 0; c < sum.size(); ++c)
  {
    changed.push_back(count[c] > 0 && sum[c] >= certain_enough * count[c]);
  }
  return changed;
}

/** Connected components of the changed cells; every other cell is a set of its own. */
DisjointSets joinChanged(const std::vector<bool>& changed, const Segments& segments)
{
  DisjointSets parts(segments.cells.size());
  for (std::uint32_t c = 0; c < changed.size(); ++c)
  {
    if (changed[c])
    {
      segments.forEachNeighbour(c,
                                [&](std::uint32_t neighbour)
                                {
                                  if (changed[neighbour])
                                  {
                                    parts.join(c, neighbour);
                                  }
                                });
    }
  }
  return parts;
}
}  // namespace

bool divideLargeSegments(const std::vector<VoxelEvidence>& evidence,
                         const std::vector<Eigen::Vector3f>& points,
                         Segments& segments)
{
  const std::size_t undivided = segments.segments;
  const std::vector<bool> changed =
      findChanged(evidence, segmentShapes(segments, points), segments);
  DisjointSets parts = joinChanged(changed, segments);
  std::vector<std::size_t> voxels(segments.cells.size(), 0);  // number of voxels of each part
  for (const std::uint32_t cell : segments.cell_of_voxel)
  {
    ++voxels[parts.find(cell)];
  }
  std::vector<std::uint32_t> number(segments.cells.size(), Segments::none);  // of each new segment
  for (std::size_t v = 0; v < evidence.size(); ++v)
  {
    const std::uint32_t cell = segments.cell_of_voxel[v];
    const std::size_t part = parts.find(cell);
    if (!changed[cell] || voxels[part] < least_voxels)
    {
      continue;
    }
    if (number[part] == Segments::none)
    {
      number[part] = static_cast<std::uint32_t>(segments.segments++);
    }
    segments.segment_of_voxel[v] = number[part];
  }
  return segments.segments > undivided;
}
}  // namespace dyslam
