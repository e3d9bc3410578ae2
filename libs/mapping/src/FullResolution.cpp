// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/core/Normals.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/mapping/FullResolution.h>
#include <dyslam/mapping/MovingInMap.h>

#include <algorithm>

namespace dyslam
{
namespace
{
Eigen::Vector3f facing(const Eigen::Vector3f& normal,
                       const Eigen::Vector3f& point,
                       const Eigen::Vector3f& sensor)
{
  return normal.dot(sensor - point) < 0 ? Eigen::Vector3f(-normal) : normal;
}
}  // namespace

void estimateMapNormals(MapPoints& points, const StaticMap& map, double radius, ThreadPool& pool)
{
  constexpr std::size_t neighbours = 20;
  const KdTree tree(points.points);
  const std::vector<LocalShape> shapes = estimateNormals(
      points.points, tree, neighbours, static_cast<float>(radius), Eigen::Vector3f::Zero(), pool);
  points.normals.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const std::uint32_t k = points.keyframe[i];
    const std::size_t lidar = points.lidar.empty() ? 0 : points.lidar[i];
    const Eigen::Vector3f& origin = map.keyframes()[k].sensorOf(lidar);
    const Eigen::Vector3d sensor = map.poses()[k] * origin.cast<double>();
    points.normals[i] = facing(shapes[i].normal, points.points[i], sensor.cast<float>());
  }
}

FullResolution::FullResolution(const StaticMap& map,
                               const StaticMapOptions& options,
                               const MapPoints& points)
    : map_(map),
      options_(options),
      points_(points),
      point_of_voxel_(map.voxelCount(), VoxelHash::none)
{
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    point_of_voxel_[points.voxel[i]] = static_cast<std::uint32_t>(i);
  }
}

std::uint32_t FullResolution::pointAt(const Eigen::Vector3d& p) const
{
  const std::uint32_t voxel = map_.voxelAt(p);
  if (voxel != VoxelHash::none)
  {
    return point_of_voxel_[voxel];
  }
  // The map has the mean of neighbouring points, which may be in the next voxel.
  for (int side = 0; side < 6; ++side)
  {
    Eigen::Vector3d next = p;
    next[side / 2] += (side % 2 == 0 ? 1 : -1) * map_.voxelSize();
    const std::uint32_t neighbour = map_.voxelAt(next);
    if (neighbour != VoxelHash::none && point_of_voxel_[neighbour] != VoxelHash::none)
    {
      return point_of_voxel_[neighbour];
    }
  }
  return VoxelHash::none;
}

MapPoints FullResolution::of(const Frame& frame, const MapRegion& region) const
{
  const std::vector<bool> moving = movingInMap(frame, options_);
  const Pose T = frame.T_map_vehicle();
  const std::vector<LidarRange> lidars = lidarRanges(frame.scan, frame.cloud);
  auto lidar = lidars.begin();
  const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
  const bool has_normals = points_.normals.size() == points_.size();
  MapPoints result;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    while (i >= lidar->end)
    {
      ++lidar;
    }
    const Eigen::Vector3d at = frame.cloud.points[i].cast<double>();
    const Eigen::Vector3d p = T * at;
    const Eigen::Vector3f rounded = p.cast<float>();  // each is in one of adjoining regions
    const double range = at.norm();
    if (moving[i] || !(range >= options_.min_range && range <= options_.max_range) ||
        !region.contains(rounded.cast<double>()))
    {
      continue;
    }
    const std::uint32_t point = pointAt(p);
    if (point == VoxelHash::none)
    {
      continue;
    }
    result.points.push_back(rounded);
    result.intensity.push_back(has_intensity ? frame.cloud.intensity[i] : 0.0F);
    result.hits.push_back(points_.hits[point]);
    result.voxel.push_back(points_.voxel[point]);
    result.keyframe.push_back(points_.keyframe[point]);
    if (!points_.lidar.empty())
    {
      result.lidar.push_back(points_.lidar[point]);
    }
    if (has_normals)
    {
      const Eigen::Vector3f sensor = (T * lidar->T_vehicle_lidar.translation()).cast<float>();
      result.normals.push_back(facing(points_.normals[point], result.points.back(), sensor));
    }
  }
  return result;
}

MapPoints thinnedFullResolution(const StaticMap& map,
                                const StaticMapOptions& options,
                                ScanStore& scans,
                                double spacing)
{
  const MapPoints points = map.points();
  const FullResolution full(map, options, points);
  VoxelHash taken;
  MapPoints result;
  for (std::size_t k = 0; k < scans.size(); ++k)
  {
    const MapPoints part = full.of(scans.read(k));
    for (std::size_t i = 0; i < part.size(); ++i)
    {
      const auto next = static_cast<std::uint32_t>(result.size());
      const auto cell = voxelCell(part.points[i], static_cast<float>(1 / spacing));
      if (taken.findOrInsert(voxelKey(cell), next) == next)
      {
        result.add(part, i);
      }
    }
  }
  return result;
}
}  // namespace dyslam
