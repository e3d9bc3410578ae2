// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/SwappedStore.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Points of one keyframe. The arrays are of one length, or empty where nothing is kept of it. */
struct KeyframeCloud
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame [m]
  std::vector<float> intensity;         //!< in [0, 1]
  std::vector<std::uint8_t> is_static;  //!< 1: static, 0: moving
  std::vector<std::uint8_t> lidar;      //!< that measured the point: ScanPart::lidar, 0: the first

  [[nodiscard]] std::size_t size() const { return points.size(); }
  /** The lidar that measured a point; 0 where that is not kept. */
  [[nodiscard]] std::size_t lidarOf(std::size_t i) const { return lidar.empty() ? 0 : lidar[i]; }
};

/** A cloud in 6 bytes a point, and one more for each of the intensity, `is_static` and `lidar`
 * where it has them. */
class PackedCloud
{
 public:
  PackedCloud() = default;
  /** Points that are not finite or have a coordinate beyond `range_limit` [m] are left out. The
   * others are rounded to 1/32767 of it (3 mm for 100 m), their intensity to 1/255.
   * \throws std::invalid_argument for arrays of different lengths and a limit that is not positive.
   */
  PackedCloud(const KeyframeCloud& cloud, double range_limit);

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  [[nodiscard]] KeyframeCloud unpacked() const;
  /** Removes the points whose flag is false. \throws std::invalid_argument unless there is one per
   * point. */
  void keepOnly(const std::vector<bool>& keep);

  // For SwappedStore.
  [[nodiscard]] std::size_t memory() const;
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static PackedCloud fromBytes(std::string_view bytes);

 private:
  float scale_ = 1;
  std::vector<std::array<std::int16_t, 3>> points_;
  std::vector<std::uint8_t> intensity_;
  std::vector<std::uint8_t> is_static_;
  std::vector<std::uint8_t> lidar_;
};

/** A keyframe without its points. */
struct Keyframe
{
  std::size_t frame = 0;   //!< Frame::index
  double stamp = 0;        //!< UNIX time [s]
  double path_length = 0;  //!< driven since the start, as measured [m]
  /** Since the start, what may have been driven without being measured: in gaps of the recording
   * and before restarts of the local map. Keyframes of one stretch have the same [m]. */
  double unseen_path = 0;
  Eigen::Vector3f sensor = Eigen::Vector3f::Zero();  //!< lidar's origin, vehicle frame [m]
  std::vector<Eigen::Vector3f> further_sensors;      //!< of further lidars, from number 1 on [m]
  Pose T_map_vehicle = Pose::Identity();

  /** Origin of a lidar, vehicle frame [m]. \param lidar ScanPart::lidar; 0: the first one. */
  [[nodiscard]] const Eigen::Vector3f& sensorOf(std::size_t lidar) const
  {
    return lidar > 0 && lidar <= further_sensors.size() ? further_sensors[lidar - 1] : sensor;
  }
};

/** Index, time, sensors and present pose of a frame, without its points. */
[[nodiscard]] Keyframe keyframeOf(const Frame& frame);

/** The keyframes of a run with their poses, in order of time; the number of a keyframe is its node
 * in the pose graph. Backend and map share one store. Not thread-safe.
 *
 * Loop closure and map each keep the points that they need: loop closure all points of the keyframe
 * at a coarse resolution, the map only those that other keyframes have not filled in. Clouds that
 * were not used recently are on disk. A reference to one is valid until the next access to one of
 * its kind.
 */
class KeyframeStore
{
 public:
  /** \param memory of backend and map together: a quarter of it is for clouds */
  explicit KeyframeStore(const MemoryLimit& memory = {});

  /** \return the keyframe's number: 0, 1, 2, ... */
  std::size_t add(const Keyframe& keyframe);

  [[nodiscard]] std::size_t size() const { return keyframes_.size(); }
  [[nodiscard]] bool empty() const { return keyframes_.empty(); }
  [[nodiscard]] const Keyframe& operator[](std::size_t i) const { return keyframes_[i]; }
  [[nodiscard]] Keyframe& operator[](std::size_t i) { return keyframes_[i]; }
  [[nodiscard]] const Keyframe& back() const { return keyframes_.back(); }
  [[nodiscard]] auto begin() const { return keyframes_.begin(); }
  [[nodiscard]] auto end() const { return keyframes_.end(); }

  /** Points alone; about 30 kB. Empty until set. */
  [[nodiscard]] const PackedCloud& loopCloud(std::size_t i) const { return loop_clouds_.get(i); }
  void setLoopCloud(std::size_t i, PackedCloud cloud) { loop_clouds_.edit(i) = std::move(cloud); }
  /** Bounded by the area seen, all keyframes together. Empty until set. */
  [[nodiscard]] const PackedCloud& mapCloud(std::size_t i) const { return map_clouds_.get(i); }
  [[nodiscard]] PackedCloud& editMapCloud(std::size_t i) { return map_clouds_.edit(i); }

  /** Of the clouds in memory [bytes]. */
  [[nodiscard]] std::size_t cloudMemory() const
  {
    return loop_clouds_.memory() + map_clouds_.memory();
  }
  /** Memory limit of backend and map together. */
  [[nodiscard]] const MemoryLimit& memory() const { return memory_; }

  /** Sets corrected poses of the keyframes from number `first` on. \throws std::invalid_argument
   * unless there is one each. */
  void correct(const std::vector<Pose>& T_map_vehicle, std::size_t first = 0);
  /** Number of corrections so far. */
  [[nodiscard]] std::size_t revision() const { return revision_; }
  void exchangeState(StateArchive& archive);

 private:
  MemoryLimit memory_;
  std::vector<Keyframe> keyframes_;
  SwappedStore<PackedCloud> loop_clouds_;
  SwappedStore<PackedCloud> map_clouds_;
  std::size_t revision_ = 0;
};
}  // namespace dyslam
