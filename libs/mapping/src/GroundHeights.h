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
  GroundHeights() = default;
  explicit GroundHeights(const std::vector<const LowestReturns*>& scans);
  /** Of the ground at `p` (map frame); limited by the neighbouring squares because of roofs. */
  [[nodiscard]] float at(const Eigen::Vector3f& p) const;
  /** Heights of points (map frame) over the ground [m]. */
  [[nodiscard]] std::vector<float> heightsOf(const std::vector<Eigen::Vector3f>& points) const;

 private:
  [[nodiscard]] float limited(const VoxelCell& square, float own) const;

  VoxelHash index_;
  std::vector<float> height_;
  std::vector<float> ground_;  //!< at(), for each of `height_`
};
}  // namespace dyslam
