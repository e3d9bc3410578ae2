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
  occluded,   //!< a ray ended before the voxel
  free,       //!< rays passed through the voxel
  passed_by,  //!< rays passed around the voxel, but too far away to exclude thin objects
  enclosed,   //!< the nearest rays above and below passed, too far away for thin objects
  occupied    //!< a ray ended in the voxel
};

/** Range image of one lidar's scan for visibility tests: nearest return per pixel. The image covers
 * the field of view that the returns show. */
class VisibilityImage
{
 public:
  /** Rays start at the sensor's position when each point was measured, if the cloud has phases.
   * \param cloud returns in the vehicle frame [m] \param lidar range of the returns that this lidar
   * measured, and its position at the cloud's stamp */
  VisibilityImage(const Cloud& cloud, const LidarRange& lidar);
  /** An image without rays, for exchangeState(). */
  VisibilityImage() = default;

  /** Evidence of the rays near the direction of each of `count` voxels of side `size` [m] (vehicle
   * frame [m]). A voxel is free if there were rays and all of them ended more than `margin` [m]
   * behind it; directions without a return (sky, black cars) prove nothing. It is occupied if a ray
   * ended within `margin`. \param[out] evidence one value per voxel */
  void at(const Eigen::Vector3f* voxels,
          std::size_t count,
          float size,
          float margin,
          Evidence* evidence) const;
  /** As at(), and for sparse rays: where no ray passed through a voxel or ended there, the nearest
   * rays above and below, up to 2.4 degrees away as between the rings of a sensor with 16, decide
   * whether it is `enclosed` or `occupied`. \param T_vehicle_voxels takes the voxels to the vehicle
   * frame */
  void evaluate(const Eigen::Vector3f* voxels,
                std::size_t count,
                const Eigen::Isometry3f& T_vehicle_voxels,
                float size,
                float margin,
                Evidence* evidence) const;
  void exchangeState(StateArchive& archive);

 private:
  static constexpr int cols = 900;
  static constexpr int side_cols = 4;  // columns that are repeated beyond each end of the turn
  static constexpr int stride = side_cols + cols + side_cols;
  static constexpr float resolution = 0.01F;  // quantum of the ranges in pixels_ [m]
  static constexpr std::uint16_t no_return = 0xFFFF;

  struct Rays;

  void fromSensor(Rays& rays) const;
  template <typename Place, typename EvidenceAt>
  void forEach(std::size_t count,
               const Place& place,
               const EvidenceAt& evidence_at,
               Evidence* evidence) const;
  [[nodiscard]] Evidence evidenceAt(int row, int col, float range, float size, float margin) const;
  [[nodiscard]] Evidence evidenceAround(
      int row, int col, float range, float size, float margin) const;
  [[nodiscard]] Evidence evidenceBetweenRows(int row, int col, float range, float margin) const;
  [[nodiscard]] Evidence evidenceInRow(int row, int col, float range, float margin) const;
  /** Range of a pixel [m], infinity where no ray returned. */
  [[nodiscard]] static float rangeOf(std::uint16_t pixel)
  {
    return pixel == no_return ? std::numeric_limits<float>::infinity()
                              : resolution * static_cast<float>(pixel);
  }
  /** Index in pixels_. \param col from -side_cols to cols + side_cols - 1 */
  [[nodiscard]] static std::size_t indexOf(int row, int col)
  {
    return static_cast<std::size_t>(row * stride + side_cols + col);
  }
  void closeTurn();
  void setRows(const std::vector<Eigen::Vector3f>& points, const LidarRange& lidar);
  void setColumnOrigins(const std::vector<Eigen::Vector3f>& sum, const std::vector<int>& count);

  Eigen::Vector3f sensor_ = Eigen::Vector3f::Zero();
  int lowest_ = 0;  // row where the image begins, from the horizon upwards
  int rows_ = 0;    // number of rows: field of view and a margin
  std::vector<Eigen::Vector3f> column_sensor_;  // sensor position for each column, or empty
  // Ranges / resolution, or no_return; row-major with repeated columns, see indexOf().
  std::vector<std::uint16_t> pixels_;
};
}  // namespace dyslam
