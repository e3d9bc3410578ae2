// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FastAngle.h>
#include <dyslam/nets/PreparedScan.h>
#include <dyslam/nets/Threads.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr float min_range = 1.5F;  // nearer points are ignored [m]
constexpr float max_range = 100;   // farther points are ignored [m]
constexpr auto pi = static_cast<float>(M_PI);

/** Image row of each slope bin, from the histogram of the slopes. */
std::vector<std::int32_t> rowsOfSlopes(const std::vector<std::size_t>& histogram,
                                       std::size_t total,
                                       int& rows)
{
  const int bins = static_cast<int>(histogram.size());
  const std::size_t tail = total / 500;
  int lowest = 0;
  int highest = bins - 1;
  for (std::size_t sum = 0;
       lowest < highest && sum + histogram[static_cast<std::size_t>(lowest)] <= tail; ++lowest)
  {
    sum += histogram[static_cast<std::size_t>(lowest)];
  }
  for (std::size_t sum = 0;
       highest > lowest && sum + histogram[static_cast<std::size_t>(highest)] <= tail; --highest)
  {
    sum += histogram[static_cast<std::size_t>(highest)];
  }

  // The beams of sparse sensors are separate clusters of slopes.
  const std::size_t min_count = total / 2000;
  std::vector<int> starts;
  std::vector<int> ends;
  int occupied = 0;
  for (int b = lowest; b <= highest; ++b)
  {
    if (histogram[static_cast<std::size_t>(b)] <= min_count)
    {
      continue;
    }
    ++occupied;
    if (ends.empty() || b - ends.back() > 6)
    {
      starts.push_back(b);
      ends.push_back(b);
    }
    ends.back() = b;
  }
  std::vector<std::int32_t> row_of(histogram.size(), 0);
  const int clusters = static_cast<int>(starts.size());
  const bool separate = clusters >= 8 && clusters <= 40 && 2 * occupied < highest - lowest;
  if (separate)
  {
    rows = clusters;
    int row = 0;
    for (int b = 0; b < bins; ++b)
    {
      while (row + 1 < clusters && 2 * b > ends[static_cast<std::size_t>(row)] +
                                               starts[static_cast<std::size_t>(row + 1)])
      {
        ++row;
      }
      row_of[static_cast<std::size_t>(b)] = row;
    }
    return row_of;
  }
  // Dense sensors: rows with equal numbers of points.
  rows = PreparedScan::max_rows;
  std::size_t sum = 0;
  for (int b = 0; b < bins; ++b)
  {
    const std::size_t count = histogram[static_cast<std::size_t>(b)];
    const std::size_t middle = sum + count / 2;
    const auto row = static_cast<std::int32_t>(middle * static_cast<std::size_t>(rows) /
                                               std::max<std::size_t>(total, 1));
    row_of[static_cast<std::size_t>(b)] = std::min(row, rows - 1);
    sum += count;
  }
  return row_of;
}

/** One occupied image cell per block, the nearest to the block's centre column. */
void sampleFirstLevel(PreparedScan& scan)
{
  PreparedScan::Level& level = scan.levels[0];
  level.rows = scan.rows >= 32 ? 32 : 16;
  level.cols = 8192 / level.rows;
  level.cell.assign(8192, -1);
  for (int i = 0; i < level.rows; ++i)
  {
    const int row_begin = i * scan.rows / level.rows;
    const int row_end = std::max(row_begin + 1, (i + 1) * scan.rows / level.rows);
    for (int j = 0; j < level.cols; ++j)
    {
      const int col_begin = j * PreparedScan::columns / level.cols;
      const int col_end = (j + 1) * PreparedScan::columns / level.cols;
      const int middle = (col_begin + col_end) / 2;
      std::int32_t best = -1;
      int best_distance = PreparedScan::columns;
      for (int row = row_begin; row < row_end; ++row)
      {
        for (int col = col_begin; col < col_end; ++col)
        {
          const std::int32_t cell = row * PreparedScan::columns + col;
          const int distance = std::abs(col - middle);
          if (distance < best_distance && scan.source[static_cast<std::size_t>(cell)] >= 0)
          {
            best = cell;
            best_distance = distance;
          }
        }
      }
      level.cell[static_cast<std::size_t>(i * level.cols + j)] = best;
    }
  }
}

/** Fits a plane to a window of constant metric width around an image cell. */
void fitPlane(const PreparedScan& scan,
              std::int32_t cell,
              Eigen::Vector3f& normal,
              float& planarity)
{
  normal.setZero();
  planarity = 0;
  const Eigen::Vector3f p = scan.points[static_cast<std::size_t>(cell)];
  const float range = p.norm();
  const int row0 = cell / PreparedScan::columns;
  const int col0 = cell % PreparedScan::columns;
  const int dilation = std::clamp(
      static_cast<int>(std::lround(0.1F / (range * 2 * pi / PreparedScan::columns))), 1, 16);
  const float gate = 0.5F + 0.05F * range;
  float count = 0;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f second = Eigen::Matrix3f::Zero();
  for (int row = std::max(0, row0 - 1); row <= std::min(scan.rows - 1, row0 + 1); ++row)
  {
    for (int k = -4; k <= 4; ++k)
    {
      const int col = (col0 + k * dilation + PreparedScan::columns) % PreparedScan::columns;
      const auto at = static_cast<std::size_t>(row * PreparedScan::columns + col);
      const Eigen::Vector3f d = scan.points[at] - p;
      const float weight = scan.source[at] >= 0 ? 1 / (1 + d.squaredNorm() / (gate * gate)) : 0.F;
      if (weight < 0.1F)
      {
        continue;
      }
      count += weight;
      mean += weight * d;
      second += weight * d * d.transpose();
    }
  }
  if (count < 3)
  {
    return;
  }
  mean /= count;
  const Eigen::Matrix3f covariance = second / count - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3f spread = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  normal = solver.eigenvectors().col(0);
  if (!normal.allFinite() || spread[2] <= 0)
  {
    normal.setZero();
    return;
  }
  if (normal.dot(p) > 0)
  {
    normal = -normal;
  }
  planarity = std::clamp((spread[1] - spread[0]) / (spread[1] + spread[0] + 1e-6F), 0.F, 1.F);
}

/** A coarser level: per block of `from` the node with the highest score. */
template <typename Score>
PreparedScan::Level coarser(const PreparedScan::Level& from, int rows, int cols, const Score& score)
{
  PreparedScan::Level level;
  level.rows = rows;
  level.cols = cols;
  level.cell.assign(static_cast<std::size_t>(rows * cols), -1);
  const int row_step = from.rows / rows;
  const int col_step = from.cols / cols;
  for (int i = 0; i < rows; ++i)
  {
    for (int j = 0; j < cols; ++j)
    {
      float best = -1;
      for (int row = i * row_step; row < (i + 1) * row_step; ++row)
      {
        for (int col = j * col_step; col < (j + 1) * col_step; ++col)
        {
          const auto node = static_cast<std::size_t>(row * from.cols + col);
          const float value = from.cell[node] >= 0 ? score(node) : -1;
          if (value > best)
          {
            best = value;
            level.cell[static_cast<std::size_t>(i * cols + j)] = static_cast<std::int32_t>(node);
          }
        }
      }
    }
  }
  return level;
}

/** The nearest point of each image cell. */
void fillImage(const std::vector<Eigen::Vector3f>& points, PreparedScan& scan)
{
  std::vector<std::int16_t> bins(points.size(), -1);
  std::vector<std::size_t> histogram(PreparedScan::slope_bins, 0);
  std::size_t total = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3f& p = points[i];
    const float range2 = p.squaredNorm();
    if (!(range2 >= min_range * min_range) || !(range2 <= max_range * max_range))
    {
      continue;  // ranges out of bounds, also NaN and infinite ones
    }
    const float slope = p.z() / std::max(p.head<2>().norm(), 1e-3F);
    bins[i] = static_cast<std::int16_t>(slopeBin(slope));
    ++histogram[static_cast<std::size_t>(bins[i])];
    ++total;
  }
  scan.row_of_slope = rowsOfSlopes(histogram, total, scan.rows);

  const auto cells = static_cast<std::size_t>(scan.rows * PreparedScan::columns);
  scan.points.assign(cells, Eigen::Vector3f::Zero());
  scan.source.assign(cells, -1);
  scan.cell_of_point.assign(points.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (bins[i] < 0)
    {
      continue;
    }
    const int row = scan.row_of_slope[static_cast<std::size_t>(bins[i])];
    const int col = imageColumn(points[i].x(), points[i].y(), PreparedScan::columns);
    const auto cell = static_cast<std::size_t>(row * PreparedScan::columns + col);
    scan.cell_of_point[i] = static_cast<std::int32_t>(cell);
    if (scan.source[cell] < 0)
    {
      ++scan.valid_points;
    }
    else if (scan.points[cell].squaredNorm() <= points[i].squaredNorm())
    {
      continue;
    }
    scan.points[cell] = points[i];
    scan.source[cell] = static_cast<std::int32_t>(i);
  }
}

/** Makes level 1: a quarter of the nodes of level 0, with normals and planarity. */
void sampleSecondLevel(PreparedScan& scan)
{
  const PreparedScan::Level& first = scan.levels[0];
  PreparedScan::Level& second = scan.levels[1];
  second = coarser(first, 16, 128, [](std::size_t) { return 0.F; });
  scan.normals.assign(second.size(), Eigen::Vector3f::Zero());
  scan.planarity.assign(second.size(), 0.F);
  forRows(static_cast<std::int64_t>(second.size()), 128,
          [&](std::int64_t from, std::int64_t to)
          {
            for (auto n = static_cast<std::size_t>(from); n < static_cast<std::size_t>(to); ++n)
            {
              if (second.cell[n] >= 0)
              {
                second.cell[n] = first.cell[static_cast<std::size_t>(second.cell[n])];
                fitPlane(scan, second.cell[n], scan.normals[n], scan.planarity[n]);
              }
            }
          });
}

/** Makes level `l`, 2 or above: per block of level l - 1 the node with the highest planarity. */
void sampleByPlanarity(PreparedScan& scan, std::size_t l, int rows, int cols)
{
  const std::size_t before = scan.first_level_of.size() - (l > 2 ? scan.levels[l - 1].size() : 0);
  const auto inFirst = [&](std::size_t node)
  { return l == 2 ? static_cast<std::int32_t>(node) : scan.first_level_of[before + node]; };
  PreparedScan::Level level = coarser(
      scan.levels[l - 1], rows, cols,
      [&](std::size_t node) { return scan.planarity[static_cast<std::size_t>(inFirst(node))]; });
  for (std::int32_t& node : level.cell)
  {
    const std::int32_t fine = node >= 0 ? inFirst(static_cast<std::size_t>(node)) : -1;
    scan.first_level_of.push_back(fine);
    node = fine >= 0 ? scan.levels[1].cell[static_cast<std::size_t>(fine)] : -1;
  }
  scan.levels[l] = std::move(level);
}
}  // namespace

int imageColumn(float x, float y, int cols)
{
  const float turn = 0.5F - turnsOf(y, x);
  return std::clamp(static_cast<int>(turn * static_cast<float>(cols)), 0, cols - 1);
}

int slopeBin(float slope)
{
  const float bin = (slope + 1) * (PreparedScan::slope_bins / 2);
  // This order of min and max maps NaN to 0.
  return static_cast<int>(std::min(std::max(0.F, bin), PreparedScan::slope_bins - 1.F));
}

PreparedScan prepareScan(const std::vector<Eigen::Vector3f>& points)
{
  PreparedScan scan;
  fillImage(points, scan);
  sampleFirstLevel(scan);
  sampleSecondLevel(scan);
  constexpr std::array<std::array<int, 2>, 3> shapes = {{{16, 64}, {8, 32}, {4, 16}}};
  for (std::size_t l = 2; l < PreparedScan::level_count; ++l)
  {
    sampleByPlanarity(scan, l, shapes[l - 2][0], shapes[l - 2][1]);
  }
  return scan;
}
}  // namespace dyslam
