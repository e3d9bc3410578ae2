// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Assignment.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace dyslam
{
namespace
{
constexpr double infinity = std::numeric_limits<double>::infinity();

/** Finite cost of an unassigned row; for always_assign so high that one more pair always lowers the
 * total cost. */
double finiteUnassignedCost(const CostMatrix& cost, double unassigned_cost)
{
  if (std::isfinite(unassigned_cost))
  {
    return unassigned_cost;
  }
  double low = infinity;
  double high = -infinity;
  for (Eigen::Index i = 0; i < cost.size(); ++i)
  {
    const double c = cost.data()[i];
    if (std::isfinite(c))
    {
      low = std::min(low, c);
      high = std::max(high, c);
    }
  }
  if (low > high)
  {
    return 0;
  }
  const auto most = static_cast<double>(std::min(cost.rows(), cost.cols()));
  return high + (most + 1) * (high - low) + 1;
}

/** Computes the other fields from `column_of_row`. */
Assignment assignmentOf(const CostMatrix& cost, const std::vector<int>& column_of_row)
{
  Assignment result;
  result.column_of_row = column_of_row;
  result.row_of_column.assign(static_cast<std::size_t>(cost.cols()), -1);
  for (std::size_t row = 0; row < column_of_row.size(); ++row)
  {
    const int column = column_of_row[row];
    if (column >= 0)
    {
      result.row_of_column[static_cast<std::size_t>(column)] = static_cast<int>(row);
      result.cost += cost(static_cast<Eigen::Index>(row), column);
      ++result.pairs;
    }
  }
  return result;
}

/** Assigns rows to columns by shortest augmenting paths. In addition to the columns every row has a
 * dummy column of its own with cost `dummy_cost`. Column potentials are at most 0, and 0 for free
 * columns; the potential of a row follows from its pair, whose reduced cost is 0. */
class ShortestPaths
{
 public:
  ShortestPaths(const CostMatrix& cost, double dummy_cost)
      : cost_(cost),
        dummy_cost_(dummy_cost),
        rows_(static_cast<int>(cost.rows())),
        columns_(static_cast<int>(cost.cols())),
        potential_(static_cast<std::size_t>(columns_), 0.0),
        column_of_(static_cast<std::size_t>(rows_), -1),
        row_of_(static_cast<std::size_t>(columns_), -1),
        distance_(static_cast<std::size_t>(columns_)),
        from_(static_cast<std::size_t>(columns_)),
        open_(static_cast<std::size_t>(columns_))
  {
  }

  std::vector<int> solve()
  {
    std::vector<int> free_rows(static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row)
    {
      free_rows[static_cast<std::size_t>(row)] = row;
    }
    for (int round = 0; round < reduction_rounds && !free_rows.empty(); ++round)
    {
      free_rows = reduceRows(free_rows);
    }
    for (const int row : free_rows)
    {
      augment(row);
    }
    return column_of_;
  }

 private:
  static constexpr int reduction_rounds = 2;

  const double* costsOf(int row) const
  {
    return cost_.data() + static_cast<std::ptrdiff_t>(row) * columns_;
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  struct Two
  {
    int best = -1;  //!< column, or -1 for the dummy
    double first = 0;
    double second = 0;
  };

  /** The two lowest reduced costs of a row. */
  Two lowestTwo(int row) const
  {
    Two two{-1, dummy_cost_, infinity};
    const double* costs = costsOf(row);
    for (int column = 0; column < columns_; ++column)
    {
      const double reduced = costs[column] - potential_[at(column)];
      if (reduced < two.second)  // false for NaN and infinity
      {
        if (reduced < two.first)
        {
          two.second = two.first;
          two.first = reduced;
          two.best = column;
        }
        else
        {
          two.second = reduced;
        }
      }
    }
    return two;
  }

  /** Each free row takes its best column and lowers its potential until the second best is as good;
   * the row that had the column is free again. Returns the rows still free. */
  std::vector<int> reduceRows(const std::vector<int>& free_rows)
  {
    std::vector<int> still_free;
    for (const int first_row : free_rows)
    {
      int row = first_row;
      // Chains are cut: equal or nearly equal costs could go round for long.
      for (int steps = 0; row >= 0; ++steps)
      {
        const Two two = lowestTwo(row);
        if (two.best < 0)
        {
          break;  // the dummy is best, and the cost of columns only rises
        }
        const int before = row_of_[at(two.best)];
        const bool gains = two.second > two.first && std::isfinite(two.second);
        if (before >= 0 && (!gains || steps >= columns_))
        {
          still_free.push_back(row);
          break;
        }
        if (gains)
        {
          potential_[at(two.best)] -= two.second - two.first;
        }
        if (before >= 0)
        {
          column_of_[at(before)] = -1;
        }
        column_of_[at(row)] = two.best;
        row_of_[at(two.best)] = row;
        row = before;
      }
    }
    std::sort(still_free.begin(), still_free.end());
    return still_free;
  }

  /** The shortest path from one free row to a free column or to the dummy of some row. */
  void augment(int start)
  {
    std::fill(distance_.begin(), distance_.end(), infinity);
    std::fill(from_.begin(), from_.end(), -1);
    std::iota(open_.begin(), open_.end(), 0);
    scanned_.clear();
    std::size_t open_count = at(columns_);
    int row = start;
    double so_far = 0;         // path length from `start` to `row`
    double row_potential = 0;  // potential of `row`; that of `start` cancels out
    double end_distance = dummy_cost_;
    int end_row = start;  // row that moves from its column to its dummy
    int end_column = -1;
    while (true)
    {
      const std::size_t nearest = extendPaths(row, so_far, row_potential, open_count);
      if (nearest == open_count || !(distance_[at(open_[nearest])] < end_distance))
      {
        break;
      }
      const int column = open_[nearest];
      so_far = distance_[at(column)];
      if (row_of_[at(column)] < 0)
      {
        end_distance = so_far;
        end_column = column;
        break;
      }
      open_[nearest] = open_[--open_count];
      scanned_.push_back(column);
      row = row_of_[at(column)];
      row_potential = costsOf(row)[column] - potential_[at(column)];
      const double leave = so_far + (dummy_cost_ - row_potential);
      if (leave < end_distance)
      {
        end_distance = leave;
        end_row = row;
      }
    }
    for (const int column : scanned_)
    {
      potential_[at(column)] += distance_[at(column)] - end_distance;
    }
    flip(start, end_row, end_column);
  }

  /** Shortens the paths to the open columns by those through a row.
   * \param so_far length of the path to the row \return position in open_ of the column at the
   * shortest distance; open_count: none can be reached */
  std::size_t extendPaths(int row, double so_far, double row_potential, std::size_t open_count)
  {
    const double* costs = costsOf(row);
    double shortest = infinity;
    std::size_t nearest = open_count;
    for (std::size_t k = 0; k < open_count; ++k)
    {
      const int column = open_[k];
      double& distance = distance_[at(column)];
      const double reached = so_far + (costs[column] - potential_[at(column)] - row_potential);
      if (reached < distance)
      {
        distance = reached;
        from_[at(column)] = row;
      }
      if (distance < shortest ||
          (distance == shortest && distance < infinity && prefers(column, open_[nearest])))
      {
        shortest = distance;
        nearest = k;
      }
    }
    return nearest;
  }

  /** Among columns at the same distance a free one ends the search; then the lowest. */
  bool prefers(int column, int other) const
  {
    const bool is_free = row_of_[at(column)] < 0;
    const bool other_free = row_of_[at(other)] < 0;
    return is_free != other_free ? is_free : column < other;
  }

  void flip(int start, int end_row, int end_column)
  {
    int column = end_column;
    if (column < 0)
    {
      column = column_of_[at(end_row)];
      column_of_[at(end_row)] = -1;
    }
    while (column >= 0)
    {
      const int row = from_[at(column)];
      const int previous = column_of_[at(row)];
      column_of_[at(row)] = column;
      row_of_[at(column)] = row;
      column = row == start ? -1 : previous;
    }
  }

  const CostMatrix& cost_;
  double dummy_cost_;
  int rows_;
  int columns_;
  std::vector<double> potential_;
  std::vector<int> column_of_;
  std::vector<int> row_of_;
  std::vector<double> distance_;
  std::vector<int> from_;
  std::vector<int> open_;
  std::vector<int> scanned_;
};
}  // namespace

Assignment assignShortestPaths(const CostMatrix& cost, double unassigned_cost)
{
  if ((cost.array() == -infinity).any())
  {
    // Comparisons drop NaN and +infinity by themselves; -infinity must be excluded.
    return assignShortestPaths((cost.array() == -infinity).select(infinity, cost), unassigned_cost);
  }
  return assignmentOf(cost,
                      ShortestPaths(cost, finiteUnassignedCost(cost, unassigned_cost)).solve());
}

Assignment assignGreedy(const CostMatrix& cost, double unassigned_cost)
{
  std::vector<std::tuple<double, int, int>> pairs;
  for (int row = 0; row < cost.rows(); ++row)
  {
    for (int column = 0; column < cost.cols(); ++column)
    {
      const double c = cost(row, column);
      if (std::isfinite(c) && c < unassigned_cost)
      {
        pairs.emplace_back(c, row, column);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<int> column_of_row(static_cast<std::size_t>(cost.rows()), -1);
  std::vector<bool> taken(static_cast<std::size_t>(cost.cols()), false);
  for (const auto& [c, row, column] : pairs)
  {
    if (column_of_row[static_cast<std::size_t>(row)] < 0 &&
        !taken[static_cast<std::size_t>(column)])
    {
      column_of_row[static_cast<std::size_t>(row)] = column;
      taken[static_cast<std::size_t>(column)] = true;
    }
  }
  return assignmentOf(cost, column_of_row);
}
}  // namespace dyslam
