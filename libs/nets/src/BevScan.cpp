// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/core/FastAngle.h>
#include <dyslam/core/Scan.h>
#include <dyslam/nets/BevScan.h>
#include <dyslam/nets/Threads.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

namespace dyslam
{
namespace
{
constexpr float ground_cell = 3.2F;
constexpr float min_z = -8;
constexpr float max_z = 8;
constexpr float bin_height = 0.1F;
constexpr int bins = static_cast<int>((max_z - min_z) / bin_height);
constexpr float unknown_height = 1e9F;
constexpr float max_depth_below = 0.5F;
constexpr float min_ground_range = 2.5F;  // nearer returns may be from the vehicle itself [m]
constexpr float seed_radius = 16;         // radius around the sensor for the seed height [m]
constexpr float max_slope = 0.12F;

constexpr float lowest_slope = -0.55F;
constexpr float highest_slope = 0.41F;

std::size_t at(int i)
{
  return static_cast<std::size_t>(i);
}

/** The lowest height with enough returns around it; unknown_height if there is none. */
float lowestSupportedHeight(const std::uint16_t* histogram)
{
  int total = 0;
  for (int b = 0; b < bins; ++b)
  {
    total += histogram[b];
  }
  const int needed = std::max(2, std::min(12, total / 12));
  for (int b = 0; b + 1 < bins; ++b)
  {
    const int here = histogram[b] + histogram[b + 1];
    if (here >= needed)
    {
      const float share = static_cast<float>(histogram[b + 1]) / static_cast<float>(here);
      return min_z + (static_cast<float>(b) + 0.5F + share) * bin_height;
    }
  }
  return unknown_height;
}
}  // namespace

void requireMultipleOf16(const std::string& field, int cells)
{
  if (cells % 16 != 0)
  {
    throw UserError(field + " = " + std::to_string(cells) + " is no multiple of 16; use " +
                    std::to_string(cells / 16 * 16) + " or " +
                    std::to_string(cells / 16 * 16 + 16));
  }
}

void BevOptions::describe(OptionsVisitor& v)
{
  v.integer("cells", cells, 64, 2048, "cells along each side of the grid, a multiple of 16");
  requireMultipleOf16("[grid] cells", cells);
  v.real("cell_size", cell_size, 0.05, 2, "side of a cell of the grid [m]");
  v.real("ground_clearance", ground_clearance, 0, 2,
         "height above ground up to which points count as ground [m]");
  v.real("max_height", max_height, 1, 20,
         "height above ground beyond which points are removed [m]");
}

BevGround::BevGround(const std::vector<Eigen::Vector3f>& points, float half_extent)
    : half_extent_(half_extent),
      width_(static_cast<int>(std::ceil(2 * half_extent / ground_cell))),
      height_(at(width_ * width_), 0.0F)
{
  std::vector<std::uint16_t> histogram(at(width_ * width_ * bins), 0);
  std::vector<std::uint8_t> seen(height_.size(), 0);
  for (const auto& p : points)
  {
    if (!isReturn(p) || p.head<2>().norm() < min_ground_range || std::abs(p.x()) >= half_extent_ ||
        std::abs(p.y()) >= half_extent_ || p.z() <= min_z || p.z() >= max_z)
    {
      continue;
    }
    const int ix = std::min(static_cast<int>((p.x() + half_extent_) / ground_cell), width_ - 1);
    const int iy = std::min(static_cast<int>((p.y() + half_extent_) / ground_cell), width_ - 1);
    const int bin = std::min(static_cast<int>((p.z() - min_z) / bin_height), bins - 1);
    auto& count = histogram[at((iy * width_ + ix) * bins + bin)];
    count = static_cast<std::uint16_t>(std::min(count + 1, 60000));
    seen[at(iy * width_ + ix)] = 1;
  }
  std::vector<std::uint8_t> known(height_.size(), 0);
  for (std::size_t i = 0; i < height_.size(); ++i)
  {
    const float low =
        seen[i] != 0 ? lowestSupportedHeight(&histogram[i * at(bins)]) : unknown_height;
    known[i] = low < unknown_height ? 1 : 0;
    height_[i] = known[i] != 0 ? low : 0;
  }
  makeConsistent(known);
}

float BevGround::seedHeight(const std::vector<int>& order,
                            const std::vector<float>& ring,
                            const std::vector<std::uint8_t>& known) const
{
  std::vector<float> heights;
  for (const int i : order)
  {
    if (known[at(i)] != 0 && (heights.size() < 3 || ring[at(i)] * ground_cell < seed_radius))
    {
      heights.push_back(height_[at(i)]);
    }
  }
  return upperMedian(heights);
}

void BevGround::collectAround(int cell,
                              const std::vector<std::uint8_t>& visited,
                              std::vector<float>& around) const
{
  const int x = cell % width_;
  const int y = cell / width_;
  around.clear();
  for (int reach = 1; reach <= 3 && around.size() < 3; ++reach)
  {
    around.clear();
    for (int ny = std::max(0, y - reach); ny <= std::min(width_ - 1, y + reach); ++ny)
    {
      for (int nx = std::max(0, x - reach); nx <= std::min(width_ - 1, x + reach); ++nx)
      {
        if (visited[at(ny * width_ + nx)] != 0)
        {
          around.push_back(height_[at(ny * width_ + nx)]);
        }
      }
    }
  }
}

void BevGround::makeConsistent(const std::vector<std::uint8_t>& known)
{
  if (std::find(known.begin(), known.end(), 1) == known.end())
  {
    return;
  }
  // Cells in order of their distance from the sensor, so that each has processed neighbours on its
  // inner side.
  const float middle = 0.5F * static_cast<float>(width_ - 1);
  std::vector<int> order(height_.size());
  std::vector<float> ring(height_.size());  // distance of a cell from the middle [cells]
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = static_cast<int>(i);
    ring[i] = std::hypot(static_cast<float>(order[i] % width_) - middle,
                         static_cast<float>(order[i] / width_) - middle);
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) { return ring[at(a)] < ring[at(b)]; });
  const float seed = seedHeight(order, ring, known);

  std::vector<std::uint8_t> visited(height_.size(), 0);
  std::vector<float> around;
  for (const int i : order)
  {
    collectAround(i, visited, around);
    const float reference = around.empty() ? seed : upperMedian(around);
    const float above = height_[at(i)] - reference;
    const float max_above = around.empty() ? max_depth_below : 0.25F + max_slope * ground_cell;
    if (known[at(i)] == 0 || above > max_above || above < -max_depth_below)
    {
      height_[at(i)] = reference;
    }
    visited[at(i)] = 1;
  }
}

float BevGround::heightAt(float x, float y) const
{
  const float last = static_cast<float>(width_ - 1);
  const float u = std::clamp((x + half_extent_) / ground_cell - 0.5F, 0.0F, last - 1e-3F);
  const float v = std::clamp((y + half_extent_) / ground_cell - 0.5F, 0.0F, last - 1e-3F);
  const int ix = static_cast<int>(u);
  const int iy = static_cast<int>(v);
  const float fx = u - static_cast<float>(ix);
  const float fy = v - static_cast<float>(iy);
  const float* row = &height_[at(iy * width_ + ix)];
  const float* next = row + width_;
  return (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * next[0] + fx * next[1]);
}

namespace
{
struct RayBin
{
  int row = 0;
  int column = 0;
  float range = 0;
};

RayBin rayBin(const Eigen::Vector3f& p)
{
  RayBin bin;
  const float flat = std::max(p.head<2>().norm(), 1e-3F);
  bin.range = std::sqrt(flat * flat + p.z() * p.z());
  const float row = (p.z() / flat - lowest_slope) / (highest_slope - lowest_slope) * BevRays::rows;
  // Clamped to just outside the image, so that the conversion to integers is defined. This order of
  // min and max maps NaN to -1.
  bin.row = static_cast<int>(std::floor(std::min(std::max(-1.0F, row), float{BevRays::rows})));
  const float turn = turnsOf(p.y(), p.x()) + 0.5F;
  bin.column = std::clamp(static_cast<int>(turn * BevRays::columns), 0, BevRays::columns - 1);
  return bin;
}
}  // namespace

BevRays::BevRays(const std::vector<Eigen::Vector3f>& points) : range_(at(rows * columns), 0.0F)
{
  for (const auto& p : points)
  {
    if (!isReturn(p))
    {
      continue;
    }
    const RayBin bin = rayBin(p);
    if (bin.row < 0 || bin.row >= rows)
    {
      continue;
    }
    float& seen = range_[at(bin.row * columns + bin.column)];
    seen = seen == 0 ? bin.range : std::min(seen, bin.range);
  }
}

void BevRays::compare(const Eigen::Vector3f& point, float* out) const
{
  std::fill(out, out + channels, 0.0F);
  const RayBin bin = rayBin(point);
  if (range_.empty() || bin.row < 0 || bin.row >= rows)
  {
    return;
  }
  float nearest = 1e9F;
  float best = 1e9F;
  int seen = 0;
  for (int row = std::max(0, bin.row - 1); row <= std::min(rows - 1, bin.row + 1); ++row)
  {
    for (int step = -1; step <= 1; ++step)
    {
      const int column = (bin.column + step + columns) % columns;
      const float range = range_[at(row * columns + column)];
      if (range > 0)
      {
        ++seen;
        nearest = std::min(nearest, range);
        best = std::min(best, std::abs(range - bin.range));
      }
    }
  }
  if (seen > 0)
  {
    out[0] = std::clamp((nearest - bin.range) / 2, -1.0F, 1.0F);
    out[1] = std::min(best, 1.0F);
    out[2] = static_cast<float>(seen) / 9;
  }
}

namespace
{
/** Stable counting sort of `order` by a digit of the cell index. */
template <typename Digit>
void sortByDigit(int digits, const Digit& digit, std::vector<std::uint32_t>& order)
{
  std::vector<std::uint32_t> next(at(digits + 1), 0);
  for (const auto i : order)
  {
    ++next[at(digit(i) + 1)];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<std::uint32_t> sorted(order.size());
  for (const auto i : order)
  {
    sorted[next[at(digit(i))]++] = i;
  }
  order.swap(sorted);
}

/** Keeps the points that have a cell, sorted by cell and then by input order. */
void sortByCell(const std::vector<Eigen::Vector3f>& points,
                const std::vector<std::int32_t>& cell_of,
                const std::vector<float>& height_of,
                BevScan& scan)
{
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (cell_of[i] >= 0)
    {
      scan.source.push_back(static_cast<std::uint32_t>(i));
    }
  }
  // Radix sort by column and row: the grid has far more cells than a scan has points.
  sortByDigit(
      scan.cells, [&](std::uint32_t i) { return cell_of[i] % scan.cells; }, scan.source);
  sortByDigit(
      scan.cells, [&](std::uint32_t i) { return cell_of[i] / scan.cells; }, scan.source);
  scan.points.reserve(scan.source.size());
  scan.height.reserve(scan.source.size());
  scan.cell.reserve(scan.source.size());
  for (const auto i : scan.source)
  {
    scan.points.push_back(points[i]);
    scan.height.push_back(height_of[i]);
    scan.cell.push_back(cell_of[i]);
  }
}

void fillFeatures(BevScan& scan)
{
  scan.features.resize(scan.size() * BevScan::feature_count);
  const float half = 0.5F * scan.cell_size;
  for (std::size_t begin = 0; begin < scan.size();)
  {
    const int cell = scan.cell[begin];
    std::size_t end = begin;
    float low = unknown_height;
    float high = -unknown_height;
    float sum = 0;
    for (; end < scan.size() && scan.cell[end] == cell; ++end)
    {
      low = std::min(low, scan.height[end]);
      high = std::max(high, scan.height[end]);
      sum += scan.height[end];
    }
    const float count = static_cast<float>(end - begin);
    const float mean = sum / count;
    const float density = 0.5F * std::log(count);
    const float x = scan.corner.x() + static_cast<float>(cell % scan.cells) * scan.cell_size + half;
    const float y = scan.corner.y() + static_cast<float>(cell / scan.cells) * scan.cell_size + half;
    for (std::size_t i = begin; i < end; ++i)
    {
      float* f = &scan.features[i * BevScan::feature_count];
      f[0] = (scan.points[i].x() - x) / half;
      f[1] = (scan.points[i].y() - y) / half;
      f[2] = scan.height[i] - 1;
      f[3] = scan.height[i] - mean;
      f[4] = density;
      f[5] = std::hypot(scan.points[i].x(), scan.points[i].y()) / 50;
      f[6] = high - 1;
      f[7] = low - 1;
    }
    begin = end;
  }
}
}  // namespace

BevScan makeBevScan(const std::vector<Eigen::Vector3f>& points,
                    const BevOptions& options,
                    const Eigen::Vector2f& centre)
{
  validate(options, "grid");
  BevScan scan;
  scan.cells = options.cells;
  scan.cell_size = static_cast<float>(options.cell_size);
  scan.corner = centre - Eigen::Vector2f::Constant(options.halfExtent());
  std::optional<BevGround> ground;
  inParallel([&] { ground.emplace(points); }, [&] { scan.rays = BevRays(points); });

  const auto clearance = static_cast<float>(options.ground_clearance);
  const auto ceiling = static_cast<float>(options.max_height);
  const float inverse = 1 / scan.cell_size;
  std::vector<std::int32_t> cell_of(points.size(), -1);
  std::vector<float> height_of(points.size(), 0.0F);
  forEachRow(points.size(), 4096,
             [&](std::size_t i)
             {
               const auto& p = points[i];
               if (!isReturn(p))
               {
                 return;
               }
               const float u = (p.x() - scan.corner.x()) * inverse;
               const float v = (p.y() - scan.corner.y()) * inverse;
               if (u < 0 || v < 0 || u >= static_cast<float>(scan.cells) ||
                   v >= static_cast<float>(scan.cells))
               {
                 return;
               }
               // Points below the ground are multipath echoes.
               height_of[i] = p.z() - ground->heightAt(p.x(), p.y());
               if (height_of[i] >= clearance && height_of[i] <= ceiling)
               {
                 const int ix = std::min(static_cast<int>(u), scan.cells - 1);
                 const int iy = std::min(static_cast<int>(v), scan.cells - 1);
                 cell_of[i] = iy * scan.cells + ix;
               }
             });
  sortByCell(points, cell_of, height_of, scan);
  fillFeatures(scan);
  return scan;
}
}  // namespace dyslam
