// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/ResidualSegmenter.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Aggregates votes of single points to moving objects.
 *
 * Points above ground are binned in a bird's-eye-view grid. Cells with more moving than static
 * votes form objects (connected components), which are kept if they have enough moving points and a
 * sufficient fraction of moving points.
 */
class MovingCells
{
 public:
  /** \param points vehicle frame [m] */
  MovingCells(const std::vector<Eigen::Vector3f>& points, const ResidualSegmenterOptions& options);

  /** Indices of the points within range and above ground; only these can be moving. */
  [[nodiscard]] const std::vector<std::uint32_t>& candidates() const { return candidates_; }

  /** \param votes one per candidate: > 0 moving, < 0 static, 0 unknown
   *  \return indices of the points of moving objects, ascending. */
  [[nodiscard]] std::vector<std::uint32_t> moving(const std::vector<std::int8_t>& votes);

 private:
  struct Cell
  {
    float lowest = 1e9F;   //!< z of the lowest point [m]
    int points = 0;        //!< number of candidates
    int moving = 0;        //!< number of candidates with a moving vote
    int voted_static = 0;  //!< number of candidates with a static vote
  };

  [[nodiscard]] int cellOf(const Eigen::Vector3f& p) const;
  [[nodiscard]] float lowestAround(int cell) const;
  [[nodiscard]] Cell& at(int cell) { return cells_[static_cast<std::size_t>(cell)]; }
  [[nodiscard]] const Cell& at(int cell) const { return cells_[static_cast<std::size_t>(cell)]; }

  ResidualSegmenterOptions options_;
  float cells_per_metre_;
  int half_width_;
  int width_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> candidates_;
  std::vector<int> candidate_cells_;
};
}  // namespace dyslam
