// SPDX-License-Identifier: BSD-3-Clause
#include "MapScene.h"

#include <dyslam/mapping/FullResolution.h>
#include <dyslam/mapping/MapTiles.h>

#include <algorithm>
#include <utility>

namespace dyslam
{
namespace
{
constexpr double full_spacing = 0.1;  // of points in full resolution [m]

MapPoints pointsFor(MapBuilder& builder, bool full_resolution)
{
  return full_resolution && builder.scans() != nullptr
             ? thinnedFullResolution(builder.map(), builder.options().map, *builder.scans(),
                                     full_spacing)
             : builder.map().points();
}

bool comesInto(const MapRegion& area, const ObjectPath& object)
{
  return area.isWhole() || std::any_of(object.path.begin(), object.path.end(),
                                       [&](const Eigen::Vector3d& p) { return area.contains(p); });
}
}  // namespace

SceneContent sceneOf(MapBuilder& builder, const MapExportOptions& exports)
{
  SceneContent scene;
  const MapRegion area = areaOf(exports, builder.origin());
  MapPoints points = pointsFor(builder, exports.full_resolution);
  if (!area.isWhole())
  {
    points = pointsWithin(points, area);
  }
  scene.points = std::move(points.points);
  scene.intensity = std::move(points.intensity);
  for (const RunScans& run : builder.runs())
  {
    const bool first = scene.trajectory.empty();
    (first ? scene.trajectory : scene.other_trajectories.emplace_back()) = run.trajectory();
    for (const auto& [id, object] : run.movingObjects())
    {
      if (!comesInto(area, object))
      {
        continue;
      }
      const int free_id = scene.object_paths.empty() ? id : scene.object_paths.rbegin()->first + 1;
      scene.object_paths[first ? id : free_id] = object.path;
      scene.boxes.push_back(object.last);
      scene.boxes.back().id = first ? id : free_id;
    }
  }
  return scene;
}
}  // namespace dyslam
