// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/KeyframeStore.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace dyslam
{
namespace
{
constexpr float steps = std::numeric_limits<std::int16_t>::max();

std::int16_t rounded(float value)
{
  return static_cast<std::int16_t>(std::lround(value));
}

template <typename Value>
void keepFlagged(std::vector<Value>& values, const std::vector<bool>& keep)
{
  if (values.empty())
  {
    return;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    if (keep[i])
    {
      values[kept++] = values[i];
    }
  }
  values.resize(kept);
  values.shrink_to_fit();
}
}  // namespace

PackedCloud::PackedCloud(const KeyframeCloud& cloud, double range_limit)
    : scale_(static_cast<float>(range_limit) / steps)
{
  const auto fits = [&](const auto& values)
  { return values.empty() || values.size() == cloud.size(); };
  if (!fits(cloud.intensity) || !fits(cloud.is_static) || !fits(cloud.lidar))
  {
    throw std::invalid_argument("PackedCloud: the cloud's arrays differ in length");
  }
  if (!(range_limit > 0) || !std::isfinite(range_limit))
  {
    throw std::invalid_argument("PackedCloud: the range limit must be positive");
  }
  points_.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    const Eigen::Vector3f p = cloud.points[i] / scale_;
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > steps)
    {
      continue;
    }
    points_.push_back({rounded(p.x()), rounded(p.y()), rounded(p.z())});
    if (!cloud.intensity.empty())
    {
      const float intensity = std::isfinite(cloud.intensity[i]) ? cloud.intensity[i] : 0.0F;
      intensity_.push_back(
          static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(intensity, 0.0F, 1.0F))));
    }
    if (!cloud.is_static.empty())
    {
      is_static_.push_back(cloud.is_static[i]);
    }
    if (!cloud.lidar.empty())
    {
      lidar_.push_back(cloud.lidar[i]);
    }
  }
  points_.shrink_to_fit();
  intensity_.shrink_to_fit();
  is_static_.shrink_to_fit();
  lidar_.shrink_to_fit();
}

KeyframeCloud PackedCloud::unpacked() const
{
  KeyframeCloud cloud;
  cloud.points.reserve(points_.size());
  for (const auto& p : points_)
  {
    cloud.points.emplace_back(scale_ * static_cast<float>(p[0]), scale_ * static_cast<float>(p[1]),
                              scale_ * static_cast<float>(p[2]));
  }
  cloud.intensity.reserve(intensity_.size());
  for (const std::uint8_t intensity : intensity_)
  {
    cloud.intensity.push_back(static_cast<float>(intensity) / 255.0F);
  }
  cloud.is_static = is_static_;
  cloud.lidar = lidar_;
  return cloud;
}

void PackedCloud::keepOnly(const std::vector<bool>& keep)
{
  if (keep.size() != points_.size())
  {
    throw std::invalid_argument("PackedCloud: one flag per point is needed");
  }
  keepFlagged(points_, keep);
  keepFlagged(intensity_, keep);
  keepFlagged(is_static_, keep);
  keepFlagged(lidar_, keep);
}

std::size_t PackedCloud::memory() const
{
  return points_.capacity() * sizeof points_[0] + intensity_.capacity() + is_static_.capacity() +
         lidar_.capacity();
}

std::string PackedCloud::toBytes() const
{
  std::string bytes(reinterpret_cast<const char*>(&scale_), sizeof scale_);
  appendBytes(bytes, points_);
  appendBytes(bytes, intensity_);
  appendBytes(bytes, is_static_);
  appendBytes(bytes, lidar_);
  return bytes;
}

PackedCloud PackedCloud::fromBytes(std::string_view bytes)
{
  PackedCloud cloud;
  takeBytes(bytes, cloud.scale_);
  takeBytes(bytes, cloud.points_);
  takeBytes(bytes, cloud.intensity_);
  takeBytes(bytes, cloud.is_static_);
  takeBytes(bytes, cloud.lidar_);
  return cloud;
}

Keyframe keyframeOf(const Frame& frame)
{
  Keyframe keyframe;
  keyframe.frame = frame.index;
  keyframe.stamp = frame.scan.stamp;
  keyframe.sensor = frame.scan.T_vehicle_lidar.translation().cast<float>();
  for (const ScanPart& part : frame.scan.parts)
  {
    keyframe.further_sensors.resize(std::max(keyframe.further_sensors.size(), part.lidar),
                                    keyframe.sensor);
    keyframe.further_sensors[part.lidar - 1] =
        (frame.scan.T_vehicle_lidar * part.T_scan_lidar.translation()).cast<float>();
  }
  keyframe.T_map_vehicle = frame.T_map_vehicle();
  return keyframe;
}

KeyframeStore::KeyframeStore(const MemoryLimit& memory)
    : memory_(memory), loop_clouds_(memory.part(0.125)), map_clouds_(memory.part(0.125))
{
}

std::size_t KeyframeStore::add(const Keyframe& keyframe)
{
  keyframes_.push_back(keyframe);
  loop_clouds_.add({});
  map_clouds_.add({});
  return keyframes_.size() - 1;
}

std::vector<Pose> KeyframeStore::poses() const
{
  std::vector<Pose> poses;
  poses.reserve(keyframes_.size());
  for (const Keyframe& keyframe : keyframes_)
  {
    poses.push_back(keyframe.T_map_vehicle);
  }
  return poses;
}

void KeyframeStore::correct(const std::vector<Pose>& T_map_vehicle, std::size_t first)
{
  if (first + T_map_vehicle.size() != keyframes_.size())
  {
    throw std::invalid_argument("KeyframeStore: " + std::to_string(T_map_vehicle.size()) +
                                " poses for " + std::to_string(keyframes_.size()) + " keyframes");
  }
  for (std::size_t i = 0; i < T_map_vehicle.size(); ++i)
  {
    keyframes_[first + i].T_map_vehicle = T_map_vehicle[i];
  }
  ++revision_;
}

void KeyframeStore::exchangeState(StateArchive& archive)
{
  archive(keyframes_, loop_clouds_, map_clouds_, revision_);
}
}  // namespace dyslam
