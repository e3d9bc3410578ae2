// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <dyslam/core/VoxelGrid.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Lowest returns of one scan in squares of the map. */
class LowestReturns
{
 public:
  LowestReturns() = default;
  /** \param T_map_vehicle pose of the vehicle at the scan. */
  LowestReturns(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3f& T_map_vehicle);

  /** Key of the square and height: a low order statistic, because multipath echoes lie below the
   * road. */
  [[nodiscard]] const std::vector<std::pair<std::uint64_t, float>>& heights() const
  {
    return heights_;
  }
  void exchangeState(StateArchive& archive);

 private:
  std::vector<std::pair<std::uint64_t, float>> heights_;
};

/** Height of the ground from several scans, so that it is known below objects, too. */
class GroundHeights
{
 public:
  explicit GroundHeights(const std::vector<const LowestReturns*>& scans);
  /** Heights of points (map frame) over the ground [m]; the ground of a square is limited by the
   * neighbouring squares because of roofs. */
  [[nodiscard]] std::vector<float> heightsOf(const std::vector<Eigen::Vector3f>& points) const;

 private:
  [[nodiscard]] float limited(const VoxelCell& square, float own) const;

  VoxelHash index_;
  std::vector<float> height_;  //!< of the squares, without the limit
};
}  // namespace dyslam
