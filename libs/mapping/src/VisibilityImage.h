// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/ScanParts.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Evidence of one scan's rays about a voxel. */
enum class Evidence
{
  none,       //!< no ray in this direction
  occluded,   //!< a ray ended before it
  free,       //!< rays passed through it
  passed_by,  //!< rays passed around it, but too far away to exclude thin objects
  enclosed,   //!< the nearest rays above and below passed it, too far away for thin objects
  occupied    //!< a ray ended there
};

/** Range image of one lidar's scan for visibility tests: nearest return per pixel. The image covers
 * the field of view that the returns show. */
class VisibilityImage
{
 public:
  /** Rays start at the sensor's position when each point was measured, if the cloud has phases.
   * \param cloud returns in the vehicle frame \param lidar those that it measured, and its origin
   * at the cloud's stamp */
  VisibilityImage(const Cloud& cloud, const LidarRange& lidar);
  /** Without rays, for exchangeState(). */
  VisibilityImage() = default;

  /** The rays near the direction of a voxel of side `size` at `p` (vehicle frame). It is free
   * if all of them ended more than `margin` behind it, and there were such rays: directions without
   * a return (sky, black cars) prove nothing. It is occupied if one ended within `margin`. */
  [[nodiscard]] Evidence at(const Eigen::Vector3f& p, float size, float margin) const;
  /** As at() for each of `count` voxels, but with sparse rays: where no ray passed through a voxel
   * or ended there, those above and below are evaluated, up to 2.4 degrees away as between the
   * rings of a sensor with 16: `enclosed` or `occupied`. Faster than one by one.
   * \param T_vehicle_voxels takes the voxels to the vehicle frame \param[out] evidence one value
   * per voxel */
  void evaluate(const Eigen::Vector3f* voxels,
                std::size_t count,
                const Eigen::Isometry3f& T_vehicle_voxels,
                float size,
                float margin,
                Evidence* evidence) const;
  void exchangeState(StateArchive& archive);

 private:
  static constexpr int cols = 900;
  static constexpr float resolution = 0.01F;  // of the ranges in pixels_ [m]
  static constexpr std::uint16_t no_return = 0xFFFF;

  struct Rays;

  void fromSensor(Rays& rays) const;
  [[nodiscard]] Evidence evidenceAt(int row, int col, float range, float size, float margin) const;
  [[nodiscard]] Evidence evidenceAround(
      int row, int col, float range, float size, float margin) const;
  [[nodiscard]] Evidence evidenceBetweenRows(int row, int col, float range, float margin) const;
  [[nodiscard]] Evidence evidenceInRow(int row, int col, float range, float margin) const;
  /** Range of a pixel, infinity where no ray returned [m]. */
  [[nodiscard]] static float rangeOf(std::uint16_t pixel)
  {
    return pixel == no_return ? std::numeric_limits<float>::infinity()
                              : resolution * static_cast<float>(pixel);
  }
  [[nodiscard]] float rangeAt(int row, int col) const
  {
    return rangeOf(pixels_[static_cast<std::size_t>(row * cols + (col + cols) % cols)]);
  }
  void setRows(const std::vector<Eigen::Vector3f>& points, const LidarRange& lidar);
  void setColumnOrigins(const std::vector<Eigen::Vector3f>& sum, const std::vector<int>& count);

  Eigen::Vector3f sensor_ = Eigen::Vector3f::Zero();
  int lowest_ = 0;                              // rows below the horizon where the image begins
  int rows_ = 0;                                // the field of view and a margin
  std::vector<Eigen::Vector3f> column_sensor_;  // where the sensor was for each column, or empty
  std::vector<std::uint16_t> pixels_;           // row-major, ranges, or no_return
};
}  // namespace dyslam
