// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/ResidualSegmenter.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** From votes of single points to whole moving objects.
 *
 * Points above ground are put in a grid seen from above; cells in which moving votes prevail are
 * joined with their neighbours, and a joined object counts if it is large and sure enough.
 */
class MovingCells
{
 public:
  MovingCells(const std::vector<Eigen::Vector3f>& points, const ResidualSegmenterOptions& options);

  /** Points within range and above ground: the only ones that can be moving. */
  [[nodiscard]] const std::vector<std::uint32_t>& candidates() const { return candidates_; }

  /** \param votes one per candidate: > 0 moving, < 0 static, 0 unknown
   *  \return the points of moving objects, ascending. */
  [[nodiscard]] std::vector<std::uint32_t> moving(const std::vector<std::int8_t>& votes);

 private:
  struct Cell
  {
    float lowest = 1e9F;  //!< height of its lowest point [m]
    int points = 0;       //!< candidates
    int moving = 0;       //!< of them, those with moving votes
    int still = 0;
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
