// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/SwappedStore.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Pose.h>

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

/** Points of one keyframe. The other arrays are as long as `points`, or empty if not kept. */
struct KeyframeCloud
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame [m]
  std::vector<float> intensity;         //!< in [0, 1]
  std::vector<std::uint8_t> is_static;  //!< 1: static, 0: moving
  std::vector<std::uint8_t> lidar;      //!< number of its lidar, see ScanPart::lidar

  [[nodiscard]] std::size_t size() const { return points.size(); }
  /** Lidar that measured a point; 0 if `lidar` is not kept. */
  [[nodiscard]] std::size_t lidarOf(std::size_t i) const { return lidar.empty() ? 0 : lidar[i]; }
};

/** A KeyframeCloud in 6 bytes per point, and one more for each of intensity, `is_static` and
 * `lidar` that it has. */
class PackedCloud
{
 public:
  PackedCloud() = default;
  /** Points that are not finite or have a coordinate beyond `range_limit` [m] are left out.
   * Coordinates are rounded to range_limit / 32767 (3 mm for 100 m), intensities to 1/255.
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
  double path_length = 0;  //!< measured distance travelled since the start [m]
  /** Distance that may have been travelled unmeasured since the start [m]: in gaps of the recording
   * and before restarts of the local map. Equal for keyframes without one in between. */
  double unseen_path = 0;
  Eigen::Vector3f sensor = Eigen::Vector3f::Zero();  //!< lidar's origin, vehicle frame [m]
  std::vector<Eigen::Vector3f> further_sensors;  //!< origins of lidars 1, 2, ..., vehicle frame [m]
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
 * were not used recently are on disk. A reference to a cloud is valid until the next access to a
 * cloud of its kind (loop closure or map).
 */
class KeyframeStore
{
 public:
  /** \param memory limit of backend and map together; a quarter of it is for the clouds */
  explicit KeyframeStore(const MemoryLimit& memory = {});

  /** \return the keyframe's number: 0, 1, 2, ... */
  std::size_t add(const Keyframe& keyframe);

  [[nodiscard]] std::size_t size() const { return keyframes_.size(); }
  [[nodiscard]] bool empty() const { return keyframes_.empty(); }
  [[nodiscard]] const Keyframe& operator[](std::size_t i) const { return keyframes_[i]; }
  [[nodiscard]] const Keyframe& back() const { return keyframes_.back(); }
  [[nodiscard]] auto begin() const { return keyframes_.begin(); }
  [[nodiscard]] auto end() const { return keyframes_.end(); }

  /** Points for loop closure, vehicle frame [m], about 30 kB per keyframe. Empty until set. */
  [[nodiscard]] const PackedCloud& loopCloud(std::size_t i) const { return loop_clouds_.get(i); }
  void setLoopCloud(std::size_t i, PackedCloud cloud) { loop_clouds_.edit(i) = std::move(cloud); }
  /** Points for the map; the size of all keyframes' together is bounded by the area seen. Empty
   * until set. */
  [[nodiscard]] const PackedCloud& mapCloud(std::size_t i) const { return map_clouds_.get(i); }
  [[nodiscard]] PackedCloud& editMapCloud(std::size_t i) { return map_clouds_.edit(i); }

  /** Size of the clouds that are in memory [bytes]. */
  [[nodiscard]] std::size_t cloudMemory() const
  {
    return loop_clouds_.memory() + map_clouds_.memory();
  }
  /** Memory limit of backend and map together. */
  [[nodiscard]] const MemoryLimit& memory() const { return memory_; }

  /** Present poses of all keyframes, Keyframe::T_map_vehicle. */
  [[nodiscard]] std::vector<Pose> poses() const;
  /** Sets corrected poses of the keyframes from number `first` on. \throws std::invalid_argument
   * unless there is one pose per keyframe. */
  void correct(const std::vector<Pose>& T_map_vehicle, std::size_t first = 0);
  /** Number of calls of correct() so far. */
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
