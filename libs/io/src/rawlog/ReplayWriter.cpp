// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/io/GzOutput.h>
#include <dyslam/io/ReplayWriter.h>
#include <dyslam/mrpt/Conversions.h>
#include <mrpt/maps/CPointsMapXYZI.h>
#include <mrpt/obs/CObservation3DScene.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/stock_objects.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ObservationOutput.h"
#include "exports/SceneParts.h"

namespace dyslam
{
using mrpt::img::TColor;

namespace
{
const TColor moving_colour(255, 40, 40);
const TColor path_colour(255, 255, 255);

/** Points of one kind with their intensities. */
struct Part
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;
};

/** To 1/64: invisible in a viewer, and gzip shrinks the file to a third. */
float coarse(float v)
{
  constexpr float steps = 64;
  // As std::round(), which is a call: half less the last bit, so that nothing below is rounded up.
  constexpr float half = 0.49999997F;
  return std::trunc(v * steps + std::copysign(half, v)) / steps;
}

Part partOf(const Frame& frame, const std::vector<bool>& moving, bool wanted, double voxel_size)
{
  Part part;
  const bool has_intensity = frame.cloud.intensity.size() == frame.cloud.size();
  const auto expected = static_cast<std::size_t>(std::count(moving.begin(), moving.end(), wanted));
  part.points.reserve(expected);
  part.intensity.reserve(expected);
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (moving[i] == wanted && frame.cloud.points[i].allFinite())
    {
      part.points.push_back(frame.cloud.points[i].unaryExpr(&coarse));
      part.intensity.push_back(has_intensity ? coarse(frame.cloud.intensity[i]) : 0.0F);
    }
  }
  if (voxel_size <= 0)
  {
    return part;
  }
  Part thinned;
  const VoxelSample sample = voxelDownsample(part.points, voxel_size);
  thinned.points.reserve(sample.index.size());
  thinned.intensity.reserve(sample.index.size());
  for (const auto i : sample.index)
  {
    thinned.points.push_back(part.points[i]);
    thinned.intensity.push_back(part.intensity[i]);
  }
  return thinned;
}

/** At most `most` of the points, evenly taken. */
Part atMost(const Part& part, std::size_t most)
{
  if (part.points.size() <= most)
  {
    return part;
  }
  Part result;
  for (std::size_t k = 0; k < most; ++k)
  {
    const std::size_t i = k * part.points.size() / most;
    result.points.push_back(part.points[i]);
    result.intensity.push_back(part.intensity[i]);
  }
  return result;
}

mrpt::maps::CPointsMapXYZI::Ptr pointsMap(const Part& part)
{
  auto map = mrpt::maps::CPointsMapXYZI::Create();
  map->resize(part.points.size());
  for (std::size_t i = 0; i < part.points.size(); ++i)
  {
    const auto& p = part.points[i];
    map->setPointFast(i, p.x(), p.y(), p.z());
    map->setPointColor_fast(i, part.intensity[i], 0, 0);
  }
  return map;
}
}  // namespace

void ReplayWriterOptions::describe(OptionsVisitor& v)
{
  v.integer("every", every, 1, 100000, "interval between written scans; 1: every scan [scans]");
  v.real("resolution", resolution, 0, 10,
         "side of the cubes with one point each in the static cloud; 0: all points [m]");
  v.integer("scene_points", scene_points, 0, 10000000,
            "most points in the 3D scene of a scan; 0: no scene");
  v.integer("trajectory_points", trajectory_points, 2, 1000000,
            "most poses of the trajectory in the 3D scene of a scan");
  v.integer("compression_level", compression_level, 0, 9,
            "level of the gzip compression: 0 none, 1 fast, 9 small");
}

struct ReplayWriter::Impl
{
  ReplayWriterOptions options;
  GzOutput file;
  std::size_t seen = 0;
  std::size_t written = 0;
  std::size_t path_stride = 1;
  std::vector<Eigen::Vector3d> odometry_path;  // every path_stride-th position
  bool closed = false;

  Impl(const std::string& path, const ReplayWriterOptions& options_in)
      : options(options_in), file(path, options_in.compression_level)
  {
  }

  Impl(const std::string& path, const ReplayWriterOptions& options_in, StateArchive& saved)
      : options(options_in), file(path, options_in.compression_level, saved)
  {
    saved(seen, written, path_stride, odometry_path);
  }

  void putCloud(const Frame& frame, const char* label, const Part& part)
  {
    mrpt::obs::CObservationPointCloud observation;
    observation.timestamp = toMrptTime(frame.scan.stamp);
    observation.sensorLabel = label;
    observation.pointcloud = pointsMap(part);
    writeObject(observation, file);
  }

  /** Appends the position; every other one is dropped where the path gets too long. */
  void extendPath(const Frame& frame)
  {
    if (!frame.T_odom_vehicle.matrix().allFinite() || seen % path_stride != 0)
    {
      return;
    }
    odometry_path.push_back(frame.T_odom_vehicle.translation());
    if (odometry_path.size() >= static_cast<std::size_t>(options.trajectory_points))
    {
      std::vector<Eigen::Vector3d> halved;
      for (std::size_t i = 0; i < odometry_path.size(); i += 2)
      {
        halved.push_back(odometry_path[i]);
      }
      odometry_path = std::move(halved);
      path_stride *= 2;
    }
  }

  void putScene(const Frame& frame, const Part& standing, const Part& moving)
  {
    mrpt::obs::CObservation3DScene observation;
    observation.timestamp = toMrptTime(frame.scan.stamp);
    observation.scene = mrpt::opengl::COpenGLScene::Create();
    auto& scene = *observation.scene;
    const auto most = static_cast<std::size_t>(options.scene_points);
    const Part drawn = atMost(standing, most);
    scene.insert(heightColoured(drawn.points, drawn.intensity, 2.0F));
    scene.insert(plainColoured(atMost(moving, most).points, moving_colour, 4.0F));
    scene.insert(mrpt::opengl::stock_objects::CornerXYZSimple(2.0F, 3.0F));
    if (frame.T_odom_vehicle.matrix().allFinite())
    {
      const Pose T_vehicle_odom = frame.T_odom_vehicle.inverse();
      std::vector<Eigen::Vector3d> path;
      for (const auto& p : odometry_path)
      {
        path.emplace_back(T_vehicle_odom * p);
      }
      path.emplace_back(Eigen::Vector3d::Zero());
      if (const auto line = polyline(path, path_colour, 3.0F))
      {
        scene.insert(line);
      }
      for (const auto& object : frame.objects)
      {
        if (object.reported)
        {
          insertObject(scene, object, T_vehicle_odom);
        }
      }
    }
    writeObject(observation, file);
  }
};

ReplayWriter::ReplayWriter(const std::string& path, const ReplayWriterOptions& options)
{
  validate(options, "replay");
  impl_ = std::make_unique<Impl>(path, options);
}

ReplayWriter::~ReplayWriter()
{
  try
  {
    // If nothing was written, an earlier file of the name is kept.
    if (impl_ && impl_->written > 0)
    {
      close();
    }
  }
  catch (const std::exception&)
  {
    // Errors are reported by close().
  }
}

ReplayWriter::ReplayWriter(ReplayWriter&&) noexcept = default;
ReplayWriter& ReplayWriter::operator=(ReplayWriter&&) noexcept = default;

void ReplayWriter::write(const Frame& frame)
{
  Impl& m = *impl_;
  if (m.closed)
  {
    throw std::logic_error("ReplayWriter is closed");
  }
  m.extendPath(frame);
  if (m.seen++ % static_cast<std::size_t>(m.options.every) != 0)
  {
    return;
  }
  auto moving = frame.moving;
  moving.resize(frame.cloud.size(), false);
  const Part standing_part = partOf(frame, moving, false, m.options.resolution);
  const Part moving_part = partOf(frame, moving, true, 0);
  if (frame.T_map_vehicle().matrix().allFinite())
  {
    writeObject(robotPose(frame.scan.stamp, "estimate", frame.T_map_vehicle()), m.file);
  }
  if (frame.T_world_vehicle_truth)
  {
    writeObject(robotPose(frame.scan.stamp, "ground_truth", *frame.T_world_vehicle_truth), m.file);
  }
  m.putCloud(frame, "static", standing_part);
  m.putCloud(frame, "moving", moving_part);
  if (m.options.scene_points > 0)
  {
    m.putScene(frame, standing_part, moving_part);
  }
  ++m.written;
}

void ReplayWriter::close()
{
  Impl& m = *impl_;
  if (m.closed)
  {
    return;
  }
  m.closed = true;
  m.file.close();
}

ReplayWriter::ReplayWriter(const std::string& path,
                           const ReplayWriterOptions& options,
                           StateArchive& saved)
    : impl_(std::make_unique<Impl>(path, options, saved))
{
}

void ReplayWriter::saveState(StateArchive& archive)
{
  archive(impl_->file, impl_->seen, impl_->written, impl_->path_stride, impl_->odometry_path);
}
}  // namespace dyslam
