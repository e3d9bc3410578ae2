// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

namespace dyslam
{
/** Costs of matching rows to columns. An entry that is not finite forbids its pair. */
using CostMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/** A one-to-one assignment of rows to columns. */
struct Assignment
{
  std::vector<int> column_of_row;  //!< -1: row not assigned
  std::vector<int> row_of_column;  //!< -1: column not assigned
  double cost = 0;                 //!< sum of the costs of the assigned pairs
  std::size_t pairs = 0;           //!< number of assigned pairs
};

/** No limit: match as many pairs as possible, then as cheaply as possible. */
constexpr double always_assign = std::numeric_limits<double>::infinity();

/** The assignment that minimises (cost of its pairs) - unassigned_cost * (number of its pairs): a
 * row stays unassigned if a pair for it would raise the total cost by more than `unassigned_cost`.
 *
 * Successive shortest paths: rows are added one by one, each by the shortest augmenting path, found
 * by Dijkstra on costs that node potentials keep non-negative. A few rounds of augmenting row
 * reduction (Jonker and Volgenant, 1987) give the start. Deterministic; ties go to the lowest
 * column. O(n^3) at worst.
 */
[[nodiscard]] Assignment assignShortestPaths(const CostMatrix& cost,
                                             double unassigned_cost = always_assign);

/** Greedy assignment, for comparison: the cheapest pair first, then the cheapest remaining pair, as
 * long as its cost is below `unassigned_cost`. Not optimal. */
[[nodiscard]] Assignment assignGreedy(const CostMatrix& cost,
                                      double unassigned_cost = always_assign);
}  // namespace dyslam
