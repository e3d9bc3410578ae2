// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/SceneExport.h>

#include <Eigen/Core>
#include <map>
#include <utility>
#include <vector>

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

  void add(const Frame& frame) override
  {
    T_odom_vehicle_.push_back(frame.T_odom_vehicle);
    for (const TrackedObject& object : frame.objects)
    {
      if (object.reported && object.dynamic)
      {
        moving_[object.id].push_back({T_odom_vehicle_.size() - 1, frame.index, object});
      }
    }
  }

  void exchangeState(StateArchive& archive) override { archive(T_odom_vehicle_, moving_); }

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
  /** An object as it was reported at one scan, odometry frame. */
  struct Report
  {
    std::size_t ordinal;  //!< of the frame
    std::size_t scan;     //!< Frame::index
    TrackedObject object;
  };

  void addMovingObjects(const RunResults& results, SceneContent& scene) const
  {
    // Loops closed since have moved the odometry frame of each scan.
    const auto T_map_odom = [&](std::size_t ordinal)
    { return results.trajectory[ordinal].pose * T_odom_vehicle_[ordinal].inverse(); };
    for (const auto& [id, reports] : moving_)
    {
      TrackedObject last;
      Pose T = Pose::Identity();
      for (const Report& report : reports)
      {
        T = T_map_odom(report.ordinal);
        last = report.object;
        if (const SmoothedObject* smoothed = findSmoothed(results.objects, report.scan, id))
        {
          last = smoothedTrack(report.object, *smoothed, T.inverse());
        }
        scene.object_paths[id].push_back(T * last.box.center);
      }
      LabelledBox box;
      box.id = id;
      box.object_class = last.object_class;
      box.box = transformed(last.box, T);
      scene.boxes.push_back(box);
      scene.velocities.push_back(T.linear() * last.velocity);
    }
  }

  double voxel_size_;
  std::vector<Pose> T_odom_vehicle_;  //!< of every frame
  std::map<int, std::vector<Report>> moving_;
};
}  // namespace

std::unique_ptr<RunOutput> makeSceneOutput(const RunOutputContext& context)
{
  return std::make_unique<SceneOutput>(context);
}
}  // namespace dyslam
