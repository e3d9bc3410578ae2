// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutputs.h"

#include <dyslam/backend/Backend.h>
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/eval/TrajectoryPlot.h>
#include <dyslam/io/CloudFiles.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/io/GroundTruth.h>
#include <dyslam/io/SceneExport.h>
#include <dyslam/io/TrajectoryFiles.h>
#include <dyslam/mapping/MapExport.h>
#include <dyslam/mapping/StaticMap.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "JsonText.h"
#include "OutputFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
std::string tumLine(double stamp, const Pose& pose)
{
  const Eigen::Quaterniond q(pose.linear());
  const auto t = pose.translation();
  char text[256];
  std::snprintf(text, sizeof text, "%.9f %.12g %.12g %.12g %.12g %.12g %.12g %.12g\n", stamp, t.x(),
                t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  return text;
}

/** A field of a CSV file. */
std::string quoted(const std::string& text)
{
  return text.find_first_of(",\"\n") == std::string::npos ? text : '"' + text + '"';
}

std::string numbered(std::size_t number, const std::string& ending)
{
  char text[32];
  std::snprintf(text, sizeof text, "%06zu", number);
  return text + ending;
}

/** SemanticKITTI's moving class of an object. */
std::uint16_t movingLabel(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
      return 252;
    case ObjectClass::cyclist:
      return 253;
    case ObjectClass::pedestrian:
      return 254;
    case ObjectClass::motorcyclist:
      return 255;
    case ObjectClass::bus:
      return 257;
    case ObjectClass::truck:
      return 258;
    case ObjectClass::unknown:
      break;
  }
  return semanticOf(label_moving);
}

std::ofstream opened(const std::string& path)
{
  std::ofstream file(path);
  if (!file)
  {
    throw UserError(path + ": cannot be written; choose another --output or mend its permissions");
  }
  return file;
}

/** Box of the odometry frame told in the lidar frame of a scan. */
Box inLidarFrame(const Box& box, const Frame& frame)
{
  const Pose T_lidar_odom = (frame.T_odom_vehicle * frame.scan.T_vehicle_lidar).inverse();
  Box result = box;
  result.center = T_lidar_odom * box.center;
  const Eigen::Vector3d heading =
      T_lidar_odom.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  result.yaw = std::atan2(heading.y(), heading.x());
  return result;
}
}  // namespace

void OutputOptions::describe(OptionsVisitor& v)
{
  v.flag("replay", replay, "replay.rawlog, for RawLogViewer");
  v.flag("simplemap", simplemap, "keyframes.simplemap");
  v.flag("pcd", pcd, "map_static.pcd");
  v.flag("ply", ply, "map_static.ply");
  v.flag("scene", scene, "map.3Dscene, for SceneViewer3D");
  v.flag("plot", plot, "trajectory.png, where there is ground truth");
  v.real("scene_voxel_size", scene_voxel_size, 0.01, 100, "m, one map point of the scene per cube");
}

RunOutputs::RunOutputs(const SlamRunSettings& settings,
                       const OutputOptions& options,
                       const ReplayWriterOptions& replay,
                       const Config& effective)
    : folder_(settings.output_folder),
      input_(fs::absolute(settings.rawlog).lexically_normal().string()),
      labels_(settings.labels),
      static_scans_(settings.static_scans),
      options_(options)
{
  prepareOutputFolder(folder_, input_);
  writeWhole(path("effective.ini"), effective.toIni());
  odometry_ = opened(path("odometry_tum.txt"));
  tracks_csv_ = opened(path("tracks.csv"));
  tracks_csv_ << "frame,stamp,id,class,x,y,z,length,width,height,yaw,vx,vy,vz,speed,dynamic,"
                 "observed,score\n";
  scans_csv_ = opened(path("scans.csv"));
  scans_csv_ << "frame,stamp,points,moving_points,odometry_converged,odometry_accepted,"
                "odometry_inliers,odometry_rmse,odometry_reason,registered,inliers,rmse,reason,"
                "forward,turn_deg,keyframe\n";
  if (labels_)
  {
    makeFolder(path("labels"));
  }
  if (static_scans_)
  {
    makeFolder(path("static_scans"));
    static_rawlog_ = std::make_unique<RawlogWriter>(path("static_scans.rawlog"));
  }
  if (options_.replay)
  {
    replay_ = std::make_unique<ReplayWriter>(path("replay.rawlog"), replay);
  }
  writer_ = std::make_unique<WriteBehind>();
}

std::string RunOutputs::path(const std::string& name)
{
  files_.push_back(name);
  return (fs::path(folder_) / name).string();
}

void RunOutputs::add(Frame frame, const Pipeline& pipeline)
{
  T_odom_vehicle_.push_back(frame.T_odom_vehicle);
  odometry_ << tumLine(frame.scan.stamp, frame.T_odom_vehicle);
  odometry_.flush();
  if (frame.T_world_vehicle_truth)
  {
    reference_.push_back(frame.scan.stamp, *frame.T_world_vehicle_truth);
  }
  addTracks(frame, pipeline);
  addScan(frame);
  if (!labels_ && !static_scans_ && !replay_)
  {
    return;
  }
  const auto shared = std::make_shared<const Frame>(std::move(frame));
  writer_->add(
      [this, shared]
      {
        const auto labels = labels_ || static_scans_ ? labelsOf(*shared) : std::vector<Label>();
        if (labels_)
        {
          writeLabels((fs::path(folder_) / "labels" / numbered(shared->index, ".label")).string(),
                      labels);
        }
        if (static_scans_)
        {
          writeStaticScan(*shared, labels);
        }
        if (replay_)
        {
          replay_->write(*shared);
        }
      });
}

void RunOutputs::addTracks(const Frame& frame, const Pipeline& pipeline)
{
  for (const auto& object : frame.objects)
  {
    if (!object.reported)
    {
      continue;
    }
    LabelledBox box;
    box.frame = static_cast<int>(frame.index);
    box.id = object.id;
    box.object_class = object.object_class;
    box.type = toString(object.object_class);
    box.box = inLidarFrame(object.box, frame);
    box.score = object.score;
    tracks_.push_back(box);
    if (object.dynamic)
    {
      MovingObject& moving = moving_[object.id];
      moving.path.push_back({T_odom_vehicle_.size() - 1, object.box.center});
      moving.last = box;
      moving.last.box = object.box;
      moving.velocity = object.velocity;
    }
    const auto& c = object.box.center;
    const auto& s = object.box.size;
    const auto& v = object.velocity;
    char text[512];
    std::snprintf(
        text, sizeof text,
        "%zu,%.6f,%d,%s,%.3f,%.3f,%.3f,%.2f,%.2f,%.2f,%.4f,%.3f,%.3f,%.3f,%.3f,%d,%d,%.3f\n",
        frame.index, frame.scan.stamp, object.id, box.type.c_str(), c.x(), c.y(), c.z(), s.x(),
        s.y(), s.z(), object.box.yaw, v.x(), v.y(), v.z(), v.norm(), object.dynamic ? 1 : 0,
        object.observed ? 1 : 0, object.score);
    tracks_csv_ << text;
  }
}

void RunOutputs::addScan(const Frame& frame)
{
  const MotionEstimate& odometry = frame.odometry;
  const MotionEstimate& refined = frame.motion;
  const Pose& step = refined.T_previous_current;
  char numbers[160];
  std::snprintf(
      numbers, sizeof numbers, "%zu,%.9f,%zu,%td,%d,%d,%zu,%.4f,", frame.index, frame.scan.stamp,
      frame.cloud.size(), std::count(frame.moving.begin(), frame.moving.end(), true),
      odometry.converged ? 1 : 0, frame.odometry_accepted ? 1 : 0, odometry.inliers, odometry.rmse);
  scans_csv_ << numbers << quoted(odometry.reason);
  std::snprintf(numbers, sizeof numbers, ",%d,%zu,%.4f,", refined.converged ? 1 : 0,
                refined.inliers, refined.rmse);
  scans_csv_ << numbers << quoted(refined.reason);
  std::snprintf(numbers, sizeof numbers, ",%.4f,%.4f,%d\n", step.translation().x(),
                rotationAngle(step) * 180 / 3.14159265358979323846, frame.is_keyframe ? 1 : 0);
  scans_csv_ << numbers;
}

std::vector<Label> RunOutputs::labelsOf(const Frame& frame)
{
  std::vector<Label> labels(frame.scan.size(), 0);
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    labels[frame.cloud.source[i]] = frame.isMoving(i) ? label_moving : label_static;
  }
  for (const auto& object : frame.objects)
  {
    if (object.detection < 0 || !object.confirmed)
    {
      continue;
    }
    const auto& detection = frame.detections[static_cast<std::size_t>(object.detection)];
    for (const auto i : detection.points)
    {
      labels[frame.cloud.source[i]] =
          makeLabel(movingLabel(object.object_class), static_cast<std::uint16_t>(object.id + 1));
    }
  }
  return labels;
}

void RunOutputs::writeStaticScan(const Frame& frame, const std::vector<Label>& labels)
{
  Scan kept = frame.scan;
  std::size_t count = 0;
  const auto keep = [&](auto& values, std::size_t from)
  {
    if (!values.empty())
    {
      values[count] = values[from];
    }
  };
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    if (!isMovingLabel(labels[i]))
    {
      keep(kept.points, i);
      keep(kept.intensity, i);
      keep(kept.time, i);
      keep(kept.ring, i);
      ++count;
    }
  }
  kept.points.resize(count);
  kept.intensity.resize(kept.intensity.empty() ? 0 : count);
  kept.time.resize(kept.time.empty() ? 0 : count);
  kept.ring.resize(kept.ring.empty() ? 0 : count);
  writeBin((fs::path(folder_) / "static_scans" / numbered(frame.index, ".bin")).string(),
           kept.points, kept.intensity);
  static_rawlog_->write(kept, frame.T_world_vehicle_truth);
}

void RunOutputs::finish(const Pipeline& pipeline)
{
  writer_->finish();
  if (replay_)
  {
    replay_->close();
  }
  if (static_rawlog_)
  {
    static_rawlog_->close();
  }
  const Trajectory trajectory = pipeline.trajectory();
  writeTrajectories(trajectory);
  writeTracks(path("tracks.txt"), tracks_);
  writeGraphs(pipeline);
  writeMap(pipeline, trajectory);
  if (options_.plot && reference_.size() > 1)
  {
    writePlot(trajectory);
  }
  tracks_csv_.close();
  scans_csv_.close();
  odometry_.close();
  if (!tracks_csv_ || !scans_csv_ || !odometry_)
  {
    throw UserError(folder_ + ": not everything could be written; is the disk full?");
  }
}

void RunOutputs::writeTrajectories(const Trajectory& trajectory)
{
  writeTum(path("trajectory_tum.txt"), trajectory);
  writeKittiPoses(path("trajectory_kitti.txt"), trajectory);
  if (!reference_.empty())
  {
    // The map begins at the first pose; the truth is told in the same frame.
    const auto start = trajectory.at(reference_[0].stamp);
    const Pose T_map_world = start.value_or(Pose::Identity()) * reference_[0].pose.inverse();
    for (std::size_t i = 0; i < reference_.size(); ++i)
    {
      reference_[i].pose = T_map_world * reference_[i].pose;
    }
    writeTum(path("reference_tum.txt"), reference_);
  }
}

void RunOutputs::writeGraphs(const Pipeline& pipeline)
{
  writeGraph(pipeline.backend().graph(), path("graph.graph"));
  writeG2o(pipeline.backend().graph(), path("graph.g2o"));
}

void RunOutputs::writeMap(const Pipeline& pipeline, const Trajectory& trajectory)
{
  if (pipeline.map() == nullptr)
  {
    return;
  }
  const StaticMap& map = *pipeline.map();
  const MapPoints points = map.points();
  if (options_.pcd)
  {
    writeMapCloud(points, path("map_static.pcd"));
  }
  if (options_.ply)
  {
    writeMapCloud(points, path("map_static.ply"));
  }
  if (options_.simplemap)
  {
    writeSimplemap(map, path("keyframes.simplemap"));
  }
  if (options_.scene)
  {
    SceneContent scene;
    for (const auto i : voxelDownsample(points.points, options_.scene_voxel_size).index)
    {
      scene.points.push_back(points.points[i]);
      scene.intensity.push_back(points.intensity[i]);
    }
    scene.trajectory = trajectory;
    scene.reference = reference_;
    addMovingObjects(trajectory, scene);
    writeScene(scene, path("map.3Dscene"));
  }
}

void RunOutputs::addMovingObjects(const Trajectory& trajectory, SceneContent& scene) const
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
    scene.boxes.push_back(object.last);
    scene.boxes.back().box = transformed(object.last.box, T);
    scene.velocities.push_back(T.linear() * object.velocity);
  }
}

void RunOutputs::writePlot(const Trajectory& trajectory)
{
  TrajectoryPlotItem item;
  item.name = "estimate";
  item.pairs = associateByTime(reference_, trajectory, 1e-3);
  TrajectoryPlotOptions options;
  options.title = fs::path(folder_).filename().string();
  options.alignment = Alignment::first;
  if (item.pairs.size() < 2)
  {
    return;
  }
  const auto png = renderTrajectoryPlot({item}, options);
  writeWhole(path("trajectory.png"),
             std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
}

void RunOutputs::writeReport(SlamRunReport& report, const std::map<std::string, double>& stage_ms)
{
  report.has_reference = hasReference();
  report.tracks = trackCount();
  const std::string file = path("report.json");
  report.files = files_;
  JsonText json;
  json.add("input", input_);
  json.add("method", report.method);
  json.add("frames", report.frames);
  json.add("unconverged", report.unconverged);
  json.add("odometry_failed", report.odometry_failed);
  json.add("keyframes", report.keyframes);
  json.add("loops", report.loops);
  json.add("tracks", report.tracks);
  json.add("map_points", report.map_points);
  json.add("path_length_m", report.path_length);
  json.add("ms_per_scan", report.ms_per_scan);
  json.add("stage_ms", stage_ms);
  json.add("warnings", report.warnings);
  json.add("files", report.files);
  writeWhole(file, json.text());
}
}  // namespace dyslam
