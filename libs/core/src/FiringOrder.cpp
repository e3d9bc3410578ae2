// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FastAngle.h>
#include <dyslam/core/FiringOrder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace dyslam
{
namespace
{
constexpr std::size_t blocks = 128;  // number of blocks of consecutive points (3 degrees each)
constexpr float min_distance = 1;    // least horizontal distance of points used [m]
constexpr float min_concentration = 0.9F;     // least mean resultant length of a block's directions
constexpr float max_backward = 0.01F;         // largest step of a block against the sweep [turns]
constexpr float min_turn = 0.75F;             // least extent of a scan [turns]
constexpr float max_turn = 1.25F;             // largest extent of a scan [turns]
constexpr float max_offset = 12.0F / 360.0F;  // largest offset of a laser from its block [turns]
constexpr std::size_t min_points = 4 * blocks;  // least number of points of a scan

[[nodiscard]] bool showsAzimuth(const Eigen::Vector3f& p)
{
  return p.allFinite() && p.head<2>().squaredNorm() > min_distance * min_distance;
}

/** Angle wrapped to [-0.5, 0.5) turns. */
[[nodiscard]] float wrapped(float turns)
{
  return turns - std::floor(turns + 0.5F);
}

[[nodiscard]] std::size_t beginOf(std::size_t block, std::size_t points)
{
  return block * points / blocks;
}

/** Mean azimuth of the points of a block. */
struct BlockAzimuth
{
  bool known = false;       //!< the block has a point far enough to show its azimuth
  bool consistent = false;  //!< the azimuths of its points agree
  float turns = 0;
};

[[nodiscard]] BlockAzimuth azimuthOf(const std::vector<Eigen::Vector3f>& points,
                                     std::size_t begin,
                                     std::size_t end)
{
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  float count = 0;
  for (std::size_t i = begin; i < end; ++i)
  {
    if (showsAzimuth(points[i]))
    {
      sum += points[i].head<2>().normalized();
      count += 1;
    }
  }
  if (count == 0)
  {
    return {};
  }
  return {true, sum.norm() >= min_concentration * count, turnsOf(sum.y(), sum.x())};
}

/** Azimuths at the middle of each block, unwrapped [turns]. */
using Sweep = std::array<float, blocks>;

/** \return nothing unless the blocks follow each other once around in one direction. */
[[nodiscard]] std::optional<Sweep> sweepOf(const std::vector<Eigen::Vector3f>& points)
{
  if (points.size() < min_points)
  {
    return std::nullopt;
  }
  Sweep sweep{};
  std::optional<std::size_t> first;
  std::size_t last = 0;
  float highest_step = 0;
  float lowest_step = 0;
  for (std::size_t b = 0; b < blocks; ++b)
  {
    const BlockAzimuth azimuth =
        azimuthOf(points, beginOf(b, points.size()), beginOf(b + 1, points.size()));
    if (!azimuth.known)
    {
      continue;
    }
    if (!azimuth.consistent)
    {
      return std::nullopt;
    }
    sweep[b] = azimuth.turns;
    if (first)
    {
      const float step = wrapped(azimuth.turns - sweep[last]);
      highest_step = std::max(highest_step, step);
      lowest_step = std::min(lowest_step, step);
      sweep[b] = sweep[last] + step;
      // Blocks without a return are interpolated.
      for (std::size_t between = last + 1; between < b; ++between)
      {
        const float share = static_cast<float>(between - last) / static_cast<float>(b - last);
        sweep[between] = sweep[last] + share * step;
      }
    }
    first = first.value_or(b);
    last = b;
  }
  if (!first)
  {
    return std::nullopt;
  }
  std::fill_n(sweep.begin(), *first, sweep[*first]);
  std::fill(sweep.begin() + static_cast<std::ptrdiff_t>(last), sweep.end(), sweep[last]);
  const float turned = sweep.back() - sweep.front();
  const float backward = turned > 0 ? -lowest_step : highest_step;
  const bool once = std::abs(turned) >= min_turn && std::abs(turned) <= max_turn;
  return once && backward <= max_backward ? std::optional<Sweep>(sweep) : std::nullopt;
}

/** Azimuth of the sweep at a point, between the middles of the blocks [turns]. */
[[nodiscard]] float sweepAt(const Sweep& sweep, std::size_t point, std::size_t points)
{
  const float place =
      (static_cast<float>(point) + 0.5F) / static_cast<float>(points) * static_cast<float>(blocks) -
      0.5F;
  const auto b =
      static_cast<std::size_t>(std::clamp(std::floor(place), 0.0F, static_cast<float>(blocks - 2)));
  const float share = place - static_cast<float>(b);
  return sweep[b] + share * (sweep[b + 1] - sweep[b]);
}
}  // namespace

bool inFiringOrder(const std::vector<Eigen::Vector3f>& points)
{
  return sweepOf(points).has_value();
}

std::vector<float> firingFractions(const std::vector<Eigen::Vector3f>& points)
{
  const std::optional<Sweep> sweep = sweepOf(points);
  if (!sweep)
  {
    return {};
  }
  const float direction = sweep->back() > sweep->front() ? 1.0F : -1.0F;
  const float start = sweepAt(*sweep, 0, points.size());
  std::vector<float> fractions;
  fractions.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    float azimuth = sweepAt(*sweep, i, points.size());
    if (showsAzimuth(points[i]))
    {
      const float offset = wrapped(turnsOf(points[i].y(), points[i].x()) - azimuth);
      azimuth += std::abs(offset) <= max_offset ? offset : 0.0F;
    }
    fractions.push_back(direction * (azimuth - start));
  }
  return fractions;
}
}  // namespace dyslam
