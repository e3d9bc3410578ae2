// SPDX-License-Identifier: BSD-3-Clause
#include "CleanedMap.h"

#include <dyslam/base/Bytes.h>

#include <algorithm>

namespace dyslam
{
namespace
{
constexpr std::size_t part_voxels = 1 << 17;
}  // namespace

std::string CleanedMap::Part::toBytes() const
{
  std::string bytes;
  appendBytes(bytes, points);
  return bytes;
}

CleanedMap::Part CleanedMap::Part::fromBytes(std::string_view bytes)
{
  Part part;
  takeBytes(bytes, part.points);
  return part;
}

CleanedMap::CleanedMap(const VoxelMap& map,
                       const StaticMapOptions& options,
                       const MemoryLimit& memory)
    : kept_(map.size()), parts_(memory)
{
  for (std::size_t i = 0; i * part_voxels < map.size(); ++i)
  {
    parts_.add({});
  }
  map.forEachCleaned(options,
                     [&](const Voxel& voxel)
                     {
                       const Eigen::Vector3f p = map.centroidOf(voxel).cast<float>();
                       parts_.edit(voxel.number / part_voxels)
                           .points.push_back({{p.x(), p.y(), p.z()},
                                              voxel.intensity / static_cast<float>(voxel.points),
                                              voxel.hits,
                                              voxel.last_lidar,
                                              voxel.number,
                                              voxel.last_keyframe});
                       kept_[voxel.number] = true;
                       ++size_;
                     });
}

void CleanedMap::forEachPart(const std::function<void(const MapPoints&)>& use) const
{
  for (std::size_t i = 0; i < parts_.size(); ++i)
  {
    std::vector<Point> points = parts_.get(i).points;
    std::sort(points.begin(), points.end(),
              [](const Point& a, const Point& b) { return a.voxel < b.voxel; });
    MapPoints part;
    for (const Point& p : points)
    {
      part.points.emplace_back(p.position[0], p.position[1], p.position[2]);
      part.intensity.push_back(p.intensity);
      part.hits.push_back(p.hits);
      part.voxel.push_back(p.voxel);
      part.keyframe.push_back(p.keyframe);
      part.lidar.push_back(p.lidar);
    }
    use(part);
  }
}
}  // namespace dyslam
