// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/SceneExport.h>

#include <Eigen/Core>
#include <map>
#include <utility>

#include "../results/ReportedObjects.h"
#include "../results/RunHistory.h"
#include "RunOutput.h"

namespace dyslam
{
namespace
{
constexpr const char* file = "map.3Dscene";

/** `map.3Dscene`: map, trajectories and moving objects. */
class SceneOutput : public RunOutput
{
 public:
  explicit SceneOutput(const RunOutputContext& context)
      : RunOutput(context, {file}), voxel_size_(context.scene_voxel_size)
  {
  }

  void finish(const RunResults& results) override
  {
    if (results.map == nullptr)
    {
      return;
    }
    const MapPoints& points = results.map_points;
    SceneContent scene;
    for (const auto i : voxelDownsample(points.points, voxel_size_).index)
    {
      scene.points.push_back(points.points[i]);
      scene.intensity.push_back(points.intensity[i]);
    }
    scene.trajectory = results.trajectory;
    scene.reference = results.reference;
    addMovingObjects(results, scene);
    writeScene(scene, path(file));
  }

 private:
  static void addMovingObjects(const RunResults& results, SceneContent& scene)
  {
    std::map<int, std::pair<LabelledBox, Eigen::Vector3d>> last;  // box and velocity, map frame
    forEachReported(results,
                    [&](const ReportedObject& state)
                    {
                      if (!state.object.dynamic)
                      {
                        return;
                      }
                      const TrackedObject& object = state.object;
                      scene.object_paths[object.id].push_back(state.T_map_odom * object.box.centre);
                      auto& [box, velocity] = last[object.id];
                      box.id = object.id;
                      box.object_class = object.object_class;
                      box.box = transformed(object.box, state.T_map_odom);
                      velocity = state.T_map_odom.linear() * object.velocity;
                    });
    for (const auto& [id, state] : last)
    {
      scene.boxes.push_back(state.first);
      scene.velocities.push_back(state.second);
    }
  }

  double voxel_size_;
};
}  // namespace

std::unique_ptr<RunOutput> makeSceneOutput(const RunOutputContext& context)
{
  return std::make_unique<SceneOutput>(context);
}
}  // namespace dyslam
