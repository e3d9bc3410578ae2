// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/SceneExport.h>

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

#include "../RunOutput.h"

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

  void add(const Frame& frame) override
  {
    T_odom_vehicle_.push_back(frame.T_odom_vehicle);
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported && object.dynamic)
      {
        MovingObject& moving = moving_[object.id];
        moving.path.push_back({T_odom_vehicle_.size() - 1, object.box.center});
        moving.last = object;
      }
    }
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
    addMovingObjects(results.trajectory, scene);
    writeScene(scene, path(file));
  }

 private:
  /** All in the odometry frame. */
  struct MovingObject
  {
    std::vector<std::pair<std::size_t, Eigen::Vector3d>> path;  //!< ordinals of frames, centres
    TrackedObject last;                                         //!< as it was reported last
  };

  void addMovingObjects(const Trajectory& trajectory, SceneContent& scene) const
  {
    // Loops closed since have moved the odometry frame of each scan.
    const auto T_map_odom = [&](std::size_t ordinal)
    { return trajectory[ordinal].pose * T_odom_vehicle_[ordinal].inverse(); };
    for (const auto& [id, object] : moving_)
    {
      for (const auto& [ordinal, centre] : object.path)
      {
        scene.object_paths[id].push_back(T_map_odom(ordinal) * centre);
      }
      const Pose T = T_map_odom(object.path.back().first);
      LabelledBox box;
      box.id = id;
      box.object_class = object.last.object_class;
      box.box = transformed(object.last.box, T);
      scene.boxes.push_back(box);
      scene.velocities.push_back(T.linear() * object.last.velocity);
    }
  }

  double voxel_size_;
  std::vector<Pose> T_odom_vehicle_;  //!< of every frame
  std::map<int, MovingObject> moving_;
};
}  // namespace

std::unique_ptr<RunOutput> makeSceneOutput(const RunOutputContext& context)
{
  return std::make_unique<SceneOutput>(context);
}
}  // namespace dyslam
