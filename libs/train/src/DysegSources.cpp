// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Labels.h>
#include <dyslam/core/Scan.h>
#include <dyslam/sim/Simulator.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace dyslam
{
namespace
{
std::string numbered(const std::string& folder, std::size_t number, const char* end)
{
  char name[32];
  std::snprintf(name, sizeof(name), "/%06zu%s", number, end);
  return folder + name;
}

struct BoxLine
{
  std::int32_t id = 0;
  Eigen::Vector3d centre;
  Eigen::Vector3d size;
  double yaw = 0;
};

/** The value after "key": from `at` on; moves `at` behind it. */
std::string valueAfter(const std::string& text, const char* key, std::size_t& at)
{
  at = text.find('"' + std::string(key) + '"', at);
  if (at == std::string::npos)
  {
    return {};
  }
  at = text.find_first_not_of(": \t\r\n\"", at + std::char_traits<char>::length(key) + 2);
  const auto end = text.find_first_of(",}\"\r\n", at);
  const auto value = text.substr(at, end - at);
  at = end;
  return value;
}

Eigen::Vector3d tripleAfter(const std::string& text, const char* key, std::size_t object)
{
  std::size_t at = text.find('"' + std::string(key) + '"', object);
  Eigen::Vector3d v;
  v.x() = std::stod(valueAfter(text, "x", at));
  v.y() = std::stod(valueAfter(text, "y", at));
  v.z() = std::stod(valueAfter(text, "z", at));
  return v;
}

/** The object that begins with the next id from `at` on; moves `at` behind the id. */
BoxLine parseBox(const std::string& text, std::size_t& at)
{
  // One object's text may name its parts in any order, all before the next object's id.
  BoxLine box;
  box.id = std::stoi(valueAfter(text, "obj_id", at));
  box.centre = tripleAfter(text, "position", at);
  box.size = tripleAfter(text, "scale", at);
  box.yaw = tripleAfter(text, "rotation", at).z();
  return box;
}

/** The boxes of one SUSTechPOINTS file. */
std::vector<BoxLine> readBoxes(const std::string& file)
{
  const std::string text = readWhole(file, "check the folder of the training data");
  std::vector<BoxLine> boxes;
  try
  {
    for (std::size_t at = 0; (at = text.find("\"obj_id\"", at)) != std::string::npos;)
    {
      boxes.push_back(parseBox(text, at));
    }
  }
  catch (const std::logic_error&)  // no number, one too large, or the text is at its end
  {
    throw UserError(file + ": object " + std::to_string(boxes.size() + 1) +
                    ": obj_id, position, scale and rotation must be numbers");
  }
  return boxes;
}

/** Marks the points in a box, and those just around it as unknown if the box moves. */
void claimPoints(const BoxLine& box, bool moving, DysegClip::Frame& frame)
{
  const Eigen::Isometry3f T_box_sensor =
      poseFromYpr(box.centre.x(), box.centre.y(), box.centre.z(), box.yaw, 0, 0)
          .inverse()
          .cast<float>();
  const Eigen::Vector3f half = 0.5F * box.size.cast<float>();
  const Eigen::Vector3f inner = half + Eigen::Vector3f::Constant(0.05F);
  const Eigen::Vector3f outer = half + Eigen::Vector3f(0.4F, 0.4F, 0.3F);
  const Eigen::Vector3f centre = box.centre.cast<float>();
  const float reach = outer.norm();
  for (std::size_t i = 0; i < frame.points.size(); ++i)
  {
    if ((frame.points[i] - centre).squaredNorm() > reach * reach)
    {
      continue;
    }
    const Eigen::Array3f at = (T_box_sensor * frame.points[i]).array().abs();
    if ((at < inner.array()).all())
    {
      frame.object[i] = box.id;
    }
    else if (moving && (at < outer.array()).all() && frame.object[i] == DysegClip::still)
    {
      frame.object[i] = DysegClip::unknown;
    }
  }
}

constexpr std::size_t speed_window = 3;  // frames to each side
// Parked motorcycles of vls128_run88, whose boxes of one frame were copied to others as they stood
// relative to the sensor.
constexpr std::int32_t first_parked = 500;
constexpr std::int32_t last_parked = 599;
}  // namespace

std::vector<Eigen::Vector3f> readPoints(const std::string& file)
{
  auto points = readBinPoints(file);
  for (auto& p : points)
  {
    if (!isReturn(p))
    {
      p.setZero();
    }
  }
  return points;
}

DysegClip loadBoxedRun(const std::string& folder, std::size_t first, std::size_t last)
{
  DysegClip clip;
  clip.name = folder;
  clip.period = 0.091;
  const auto poses = readPoses12(folder + "/poses_icp_frame_to_frame.txt");
  if (poses.size() <= last)
  {
    throw UserError(folder + ": fewer poses than frames asked for");
  }
  std::vector<std::vector<BoxLine>> boxes;
  std::map<std::int32_t, std::map<std::size_t, Eigen::Vector2d>> tracks;
  for (std::size_t f = first; f <= last; ++f)
  {
    boxes.push_back(readBoxes(numbered(folder + "/label_json", f, ".json")));
    for (const auto& b : boxes.back())
    {
      tracks[b.id][f] = (poses[f] * b.centre).head<2>();
    }
  }
  for (std::size_t f = first; f <= last; ++f)
  {
    DysegClip::Frame frame;
    frame.T_world_sensor = poses[f];
    frame.points = readPoints(numbered(folder + "/velodyne", f, ".bin"));
    frame.object.assign(frame.points.size(), DysegClip::still);
    for (const auto& b : boxes[f - first])
    {
      if (b.id >= first_parked && b.id <= last_parked)
      {
        continue;
      }
      const auto& track = tracks[b.id];
      auto from = track.lower_bound(f < speed_window ? 0 : f - speed_window);
      auto to = std::prev(track.upper_bound(f + speed_window));
      const double seconds = clip.period * static_cast<double>(to->first - from->first);
      const double speed = seconds > 0 ? (to->second - from->second).norm() / seconds : 0;
      DysegClip::Object object;
      object.T_sensor_object =
          poseFromYpr(b.centre.x(), b.centre.y(), b.centre.z() - 0.5 * b.size.z(), b.yaw, 0, 0);
      object.moving = speed > moving_over;
      object.doubtful = !object.moving && (speed > standing_under || seconds <= 0);
      frame.objects[b.id] = object;
      claimPoints(b, object.moving, frame);
    }
    clip.frames.push_back(std::move(frame));
  }
  return clip;
}

DysegClip loadLabelledRun(const std::string& folder,
                          const std::string& pose_file,
                          std::size_t first,
                          std::size_t last)
{
  DysegClip clip;
  clip.name = folder;
  clip.period = 0.1034;
  const auto poses = readPoses12(pose_file);
  if (poses.size() <= last)
  {
    throw UserError(pose_file + ": fewer poses than frames asked for");
  }
  for (std::size_t f = first; f <= last; ++f)
  {
    DysegClip::Frame frame;
    frame.T_world_sensor = poses[f];
    frame.points = readPoints(numbered(folder + "/velodyne", f, ".bin"));
    const auto labels = readLabels(numbered(folder + "/labels", f, ".label"), frame.points.size());
    frame.object.assign(frame.points.size(), DysegClip::still);
    std::map<std::int32_t, std::pair<Eigen::Vector3d, int>> sums;
    for (std::size_t i = 0; i < frame.points.size(); ++i)
    {
      if (isIgnoredLabel(labels[i]))
      {
        frame.object[i] = DysegClip::unknown;
      }
      else if (isMovingLabel(labels[i]))
      {
        const auto id = static_cast<std::int32_t>(labels[i] >> 16U) + 1;
        frame.object[i] = id;
        auto& sum = sums.try_emplace(id, Eigen::Vector3d::Zero(), 0).first->second;
        sum.first += frame.points[i].cast<double>();
        ++sum.second;
      }
    }
    for (const auto& [id, sum] : sums)
    {
      // An id of its own per frame: where it was before is not known.
      const auto own = id + static_cast<std::int32_t>(f + 1) * 100000;
      DysegClip::Object object;
      object.T_sensor_object.translation() = sum.first / sum.second;
      object.moving = true;
      frame.objects[own] = object;
    }
    for (auto& o : frame.object)
    {
      o = o > 0 ? o + static_cast<std::int32_t>(f + 1) * 100000 : o;
    }
    clip.frames.push_back(std::move(frame));
  }
  return clip;
}

DysegClip simulateClip(std::uint64_t seed, int scans, bool deskewed, const DysegClipScene& scene)
{
  RandomDraws draws(0x5EED, seed);
  sim::SimulatorOptions options;
  options.world = scene.world;
  options.sensor = scene.sensor;
  options.seed = static_cast<int>(seed % 2000000000U);
  options.traffic = draws.uniform(0.3, 1.0);
  options.traffic = scene.traffic < 0 ? options.traffic : scene.traffic;
  options.start_fraction = draws.uniform();
  options.start_time = draws.uniform(3, 15);
  options.loop_length = 300;
  options.stops = true;
  sim::Simulator simulator(options);
  DysegClip clip;
  clip.name = "simulated " + std::to_string(seed);
  for (int s = 0; s < scans; ++s)
  {
    auto scan = simulator.next();
    DysegClip::Frame frame;
    frame.T_world_sensor = scan.T_map_vehicle * scan.scan.T_vehicle_lidar;
    frame.points = deskewed ? std::move(scan.deskewed) : std::move(scan.scan.points);
    frame.object.assign(frame.points.size(), DysegClip::still);
    for (const auto& o : scan.objects)
    {
      DysegClip::Object object;
      const Box& box = o.points > 0 ? o.box_seen : o.box;
      object.T_sensor_object =
          poseFromYpr(box.center.x(), box.center.y(), box.center.z(), box.yaw, 0, 0);
      const double speed = o.velocity.norm();
      object.moving = speed > moving_over;
      object.doubtful = !object.moving && speed > standing_under;
      frame.objects[o.id] = object;
    }
    for (std::size_t i = 0; i < frame.points.size(); ++i)
    {
      const auto id = static_cast<std::int32_t>(scan.label[i] >> 16U);
      if (frame.objects.count(id) != 0 && scan.moving[i] != 0)
      {
        frame.object[i] = id;
      }
      else if (frame.objects.count(id) != 0 && frame.objects[id].doubtful)
      {
        frame.object[i] = id;
      }
    }
    clip.frames.push_back(std::move(frame));
  }
  return clip;
}
}  // namespace dyslam
