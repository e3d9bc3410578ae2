// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/SceneExport.h>

#include <Eigen/Core>
#include <map>
#include <utility>

#include "../RunHistory.h"
#include "../RunOutput.h"
#include "SmoothedTracks.h"

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
    std::map<int, std::pair<LabelledBox, Eigen::Vector3d>> last;  // and velocity, map frame
    results.history->forEachReported(
        [&](const ReportedObject& report)
        {
          if (!report.dynamic)
          {
            return;
          }
          // Loops closed since have moved the odometry frame of each scan.
          const PastScan& scan = results.history->scans()[report.scan];
          const Pose T = results.trajectory[report.scan].pose * scan.T_odom_vehicle.inverse();
          TrackedObject object = report.tracked();
          if (const SmoothedObject* smoothed = findSmoothed(results.objects, scan.index, report.id))
          {
            object = smoothedTrack(object, *smoothed, T.inverse());
          }
          scene.object_paths[report.id].push_back(T * object.box.center);
          auto& [box, velocity] = last[report.id];
          box.id = report.id;
          box.object_class = object.object_class;
          box.box = transformed(object.box, T);
          velocity = T.linear() * object.velocity;
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
