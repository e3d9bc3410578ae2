// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Points of one keyframe, unpacked. The arrays are of one length. */
struct KeyframeCloud
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame [m]
  std::vector<float> intensity;         //!< in [0, 1]
  std::vector<std::uint8_t> is_static;  //!< 1: static, 0: moving

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

/** What is kept of a keyframe beside its points. */
struct KeyframeInfo
{
  std::size_t frame = 0;                             //!< Frame::index
  double stamp = 0;                                  //!< UNIX time [s]
  Eigen::Vector3f sensor = Eigen::Vector3f::Zero();  //!< lidar's origin, vehicle frame [m]
};

/** Thinned keyframe clouds in 8 bytes a point: coordinates in 1/32767 of the range limit (3 mm at
 * 100 m), intensity in 1/255. */
class KeyframeStore
{
 public:
  /** \param range_limit largest coordinate that can be kept [m]; points beyond are left out. */
  explicit KeyframeStore(double range_limit);

  /** Appends a keyframe; points that are not finite or beyond the limit are left out. */
  void add(const KeyframeInfo& info, const KeyframeCloud& cloud);
  /** Removes the points of keyframe `i` for which keep[point] is false. */
  void thin(std::size_t i, const std::vector<bool>& keep);

  [[nodiscard]] std::size_t size() const { return infos_.size(); }
  [[nodiscard]] const KeyframeInfo& info(std::size_t i) const { return infos_.at(i); }
  [[nodiscard]] KeyframeCloud cloud(std::size_t i) const;
  /** Points of all keyframes together. */
  [[nodiscard]] std::size_t pointCount() const { return point_count_; }

 private:
  struct PackedPoint
  {
    std::int16_t x;
    std::int16_t y;
    std::int16_t z;
    std::uint8_t intensity;
    std::uint8_t is_static;
  };

  float scale_;
  std::size_t point_count_ = 0;
  std::vector<KeyframeInfo> infos_;
  std::vector<std::vector<PackedPoint>> points_;
};
}  // namespace dyslam
