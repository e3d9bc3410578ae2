// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace dyslam
{
// The ground in squares of a horizontal grid, joined from the lowest returns of several scans.

constexpr float ground_square = 2.0F;       //!< side of the large squares [m]
constexpr float fine_ground_square = 0.5F;  //!< side of the small squares [m]

/** \param p odometry frame [m] \param side side of the squares [m] */
[[nodiscard]] inline VoxelCell groundSquareOf(const Eigen::Vector3f& p, float side)
{
  return voxelCell(Eigen::Vector3f(p.x(), p.y(), 0), 1 / side);
}

/** Squares, numbered as they are added. */
class NumberedSquares
{
 public:
  /** \return number of the square, which may have been added before */
  std::uint32_t add(const VoxelCell& square);
  [[nodiscard]] std::size_t size() const { return keys_.size(); }
  [[nodiscard]] std::uint64_t keyOf(std::size_t number) const { return keys_[number]; }
  [[nodiscard]] const VoxelCell& operator[](std::size_t number) const { return squares_[number]; }
  /** Number of the square, or VoxelHash::none. */
  [[nodiscard]] std::uint32_t find(std::uint64_t key) const { return index_.find(key); }

 private:
  VoxelHash index_;  // from keys to numbers
  std::vector<std::uint64_t> keys_;
  std::vector<VoxelCell> squares_;
  std::optional<std::uint64_t> last_key_;
  std::uint32_t last_ = 0;  // number of the square that was added last
};

/** Heights that one scan has in squares: voxelKey() of each square, z [m]. */
using SquareHeights = std::vector<std::pair<std::uint64_t, float>>;

/** Ground of each square: the lower quartile of the scans' heights [m]; NaN where fewer than
 * `fewest` scans have a height. */
[[nodiscard]] std::vector<float> joinGround(const std::vector<const SquareHeights*>& scans,
                                            const NumberedSquares& squares,
                                            std::uint32_t fewest);
}  // namespace dyslam
