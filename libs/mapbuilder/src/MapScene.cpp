// SPDX-License-Identifier: BSD-3-Clause
#include "MapScene.h"

#include <dyslam/mapping/FullResolution.h>

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
}  // namespace

SceneContent sceneOf(MapBuilder& builder, bool full_resolution)
{
  SceneContent scene;
  MapPoints points = pointsFor(builder, full_resolution);
  scene.points = std::move(points.points);
  scene.intensity = std::move(points.intensity);
  for (const RunScans& run : builder.runs())
  {
    const bool first = scene.trajectory.empty();
    (first ? scene.trajectory : scene.other_trajectories.emplace_back()) = run.trajectory();
    for (const auto& [id, object] : run.movingObjects())
    {
      const int free_id = scene.object_paths.empty() ? id : scene.object_paths.rbegin()->first + 1;
      scene.object_paths[first ? id : free_id] = object.path;
      scene.boxes.push_back(object.last);
      scene.boxes.back().id = first ? id : free_id;
    }
  }
  return scene;
}
}  // namespace dyslam
