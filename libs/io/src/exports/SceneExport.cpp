// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Ceilings.h>
#include <dyslam/io/GzOutput.h>
#include <dyslam/io/SceneExport.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/opengl/CGridPlaneXY.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "SceneParts.h"
#include "rawlog/ObservationOutput.h"

namespace dyslam
{
using mrpt::img::TColor;

namespace
{
const TColor estimate_colour(255, 255, 255);
const TColor reference_colour(255, 120, 200);

std::vector<Eigen::Vector3d> positions(const Trajectory& trajectory)
{
  std::vector<Eigen::Vector3d> result;
  for (const auto& stamped : trajectory)
  {
    if (stamped.pose.matrix().allFinite())
    {
      result.emplace_back(stamped.pose.translation());
    }
  }
  return result;
}

void insert(mrpt::opengl::COpenGLScene& scene,
            const mrpt::opengl::CRenderizable::Ptr& object,
            const std::string& name)
{
  if (object)
  {
    object->setName(name);
    scene.insert(object);
  }
}

mrpt::opengl::CRenderizable::Ptr gridUnder(const std::vector<Eigen::Vector3d>& path)
{
  Eigen::Vector3d low = Eigen::Vector3d::Constant(-20);
  Eigen::Vector3d high = Eigen::Vector3d::Constant(20);
  low.z() = path.empty() ? 0 : path.front().z();
  for (const auto& p : path)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  constexpr double margin = 30;
  constexpr double step = 10;
  const auto down = [](double v)
  { return static_cast<float>(std::floor((v - margin) / step) * step); };
  const auto up = [](double v)
  { return static_cast<float>(std::ceil((v + margin) / step) * step); };
  auto grid = mrpt::opengl::CGridPlaneXY::Create(down(low.x()), up(high.x()), down(low.y()),
                                                 up(high.y()), static_cast<float>(low.z()) - 3.0F,
                                                 static_cast<float>(step));
  grid->setColor_u8(TColor(70, 70, 70));
  return grid;
}

void insertBoxes(mrpt::opengl::COpenGLScene& scene, const SceneContent& content)
{
  for (std::size_t i = 0; i < content.boxes.size(); ++i)
  {
    const LabelledBox& object = content.boxes[i];
    const TColor colour = objectColour(object.id);
    const std::string name = "object " + std::to_string(object.id);
    insert(scene, wireBox(object.box, Pose::Identity(), colour), name);
    const Eigen::Vector3d over(0, 0, 0.5 * object.box.size.z() + 0.5);
    insert(scene,
           textAt(toString(object.object_class) + " " + std::to_string(object.id),
                  object.box.centre + over, colour),
           name + " label");
    if (i < content.velocities.size())
    {
      const Eigen::Vector3d top =
          object.box.centre + Eigen::Vector3d(0, 0, 0.5 * object.box.size.z());
      if (const auto shape = velocityArrow(top, content.velocities[i], colour))
      {
        insert(scene, shape, name + " velocity");
      }
    }
  }
}

/** Points of the map; those of ceilings, which would hide the others, as an object of their own
 * that is not visible. */
void insertPoints(const SceneContent& content, mrpt::opengl::COpenGLScene& scene)
{
  constexpr float point_size = 3;  // [pixels]
  const std::vector<bool> is_ceiling = ceilingPointsIfMany(content.points);
  if (std::find(is_ceiling.begin(), is_ceiling.end(), true) == is_ceiling.end())
  {
    if (!content.points.empty())
    {
      insert(scene, heightColoured(content.points, content.intensity, point_size), "map");
    }
    return;
  }
  const bool has_intensity = content.intensity.size() == content.points.size();
  std::array<std::vector<Eigen::Vector3f>, 2> points;  // others, ceilings
  std::array<std::vector<float>, 2> intensity;
  for (std::size_t i = 0; i < content.points.size(); ++i)
  {
    const std::size_t part = is_ceiling[i] ? 1 : 0;
    points[part].push_back(content.points[i]);
    if (has_intensity)
    {
      intensity[part].push_back(content.intensity[i]);
    }
  }
  const HeightRange range = heightRange(points[0]);
  insert(scene, heightColoured(points[0], intensity[0], range, point_size), "map");
  const auto ceilings = heightColoured(points[1], intensity[1], range, point_size);
  ceilings->setVisibility(false);
  insert(scene, ceilings, "ceilings");
}

/** The whole path and what is beside it, from behind and above. */
void lookAt(const std::vector<Eigen::Vector3d>& path, mrpt::opengl::COpenGLScene& scene)
{
  Eigen::Vector3d low = path.front();
  Eigen::Vector3d high = path.front();
  for (const auto& p : path)
  {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const Eigen::Vector3d middle = 0.5 * (low + high);
  constexpr double beside = 30.0;  // [m]
  auto& camera = scene.getViewport()->getCamera();
  camera.setPointingAt(static_cast<float>(middle.x()), static_cast<float>(middle.y()),
                       static_cast<float>(middle.z()));
  camera.setZoomDistance(static_cast<float>((high - low).head<2>().norm() + 2 * beside));
  camera.setAzimuthDegrees(-135.0F);
  camera.setElevationDegrees(45.0F);
}

mrpt::opengl::COpenGLScene sceneOf(const SceneContent& content)
{
  mrpt::opengl::COpenGLScene scene;
  const auto path = positions(content.trajectory);
  scene.getViewport()->setCustomBackgroundColor(mrpt::img::TColorf(0.10F, 0.11F, 0.13F));
  insert(scene, gridUnder(path), "grid");
  insertPoints(content, scene);
  insert(scene, polyline(positions(content.reference), reference_colour, 2.0F), "reference");
  insert(scene, polyline(path, estimate_colour, 3.0F), "trajectory");
  for (std::size_t i = 0; i < content.other_trajectories.size(); ++i)
  {
    insert(scene, polyline(positions(content.other_trajectories[i]), estimate_colour, 3.0F),
           "trajectory " + std::to_string(i + 2));
  }
  if (!path.empty())
  {
    auto corner = mrpt::opengl::stock_objects::CornerXYZSimple(3.0F, 3.0F);
    corner->setPose(toMrpt(content.trajectory[content.trajectory.size() - 1].pose));
    insert(scene, corner, "vehicle");
    lookAt(path, scene);
  }
  insertBoxes(scene, content);
  for (const auto& [id, object_path] : content.object_paths)
  {
    insert(scene, polyline(object_path, objectColour(id), 2.0F),
           "object path " + std::to_string(id));
  }
  return scene;
}
}  // namespace

void writeScene(const SceneContent& content, const std::string& path)
{
  constexpr int compression_level = 6;
  GzOutput file(path, compression_level);
  writeObject(sceneOf(content), file);
  file.close();
}
}  // namespace dyslam
