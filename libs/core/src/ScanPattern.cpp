// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/core/FiringOrder.h>
#include <dyslam/core/PointTimes.h>
#include <dyslam/core/Rings.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/ScanPattern.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dyslam
{
namespace
{
constexpr std::size_t min_rings = 4;
constexpr std::size_t min_ring_points = 20;
/** Largest median distance of a ring's points from its elevation, relative to the ring spacing. */
constexpr float max_ring_spread = 0.35F;
constexpr std::size_t min_displaced_rings = 8;
/** For displaced rings: the same, relative to the range of elevations of the rings. */
constexpr float max_displaced_spread = 0.25F;
/** Share of the returns left out at either end of the elevations. */
constexpr double trimmed_share = 0.0005;
/** A gap narrower than this does not end the field of view [degrees]. */
constexpr int min_gap = 20;
/** Rings that are examined point by point. */
constexpr std::size_t examined_rings = 8;

struct Ring
{
  float elevation = 0;
  float spread = 0;  //!< median distance of the points from the ring's elevation
  std::uint16_t number = 0;
};

/** Rings with enough points, by ascending elevation. */
std::vector<Ring> measureRings(const std::vector<Eigen::Vector3f>& points,
                               const std::vector<std::uint16_t>& numbers)
{
  std::vector<std::vector<float>> elevations;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (isReturn(points[i]))
    {
      elevations.resize(std::max<std::size_t>(elevations.size(), numbers[i] + 1U));
      elevations[numbers[i]].push_back(elevationOf(points[i]));
    }
  }
  std::vector<Ring> rings;
  for (std::size_t r = 0; r < elevations.size(); ++r)
  {
    if (elevations[r].size() < min_ring_points)
    {
      continue;
    }
    Ring ring;
    ring.number = static_cast<std::uint16_t>(r);
    ring.elevation = quantile(elevations[r], 0.5);
    for (float& e : elevations[r])
    {
      e = std::fabs(e - ring.elevation);
    }
    ring.spread = quantile(elevations[r], 0.5);
    rings.push_back(ring);
  }
  std::sort(
      rings.begin(), rings.end(),
      [](const Ring& a, const Ring& b)
      { return a.elevation < b.elevation || (a.elevation == b.elevation && a.number < b.number); });
  return rings;
}

/** Elevation steps between neighbouring rings; a step over rings without returns, by their numbers,
 * is divided. Numbers in between that belong to other rings do not count: lasers may be numbered in
 * the order of firing. */
std::vector<float> spacings(const std::vector<Ring>& rings)
{
  std::vector<int> rings_below(65537, 0);  // by number
  for (const Ring& ring : rings)
  {
    rings_below[ring.number + 1U] = 1;
  }
  std::partial_sum(rings_below.begin(), rings_below.end(), rings_below.begin());
  std::vector<float> steps;
  for (std::size_t r = 1; r < rings.size(); ++r)
  {
    const auto [low, high] = std::minmax(rings[r - 1].number, rings[r].number);
    const int missing = high - low - (rings_below[high] - rings_below[low]);
    steps.push_back((rings[r].elevation - rings[r - 1].elevation) /
                    static_cast<float>(1 + missing));
  }
  return steps;
}

float medianSpread(const std::vector<Ring>& rings)
{
  std::vector<float> spreads;
  for (const Ring& ring : rings)
  {
    spreads.push_back(ring.spread);
  }
  return quantile(spreads, 0.5);
}

/** Whether each ring has an elevation of its own. */
bool areRings(const std::vector<Ring>& rings)
{
  if (rings.size() < min_rings)
  {
    return false;
  }
  std::vector<float> steps = spacings(rings);
  return medianSpread(rings) < max_ring_spread * quantile(steps, 0.5);
}

/** Horizontal field of view [rad]; 2 pi for a full revolution. */
double azimuthExtent(const std::vector<Eigen::Vector3f>& points)
{
  std::array<bool, 360> seen{};
  for (const Eigen::Vector3f& p : points)
  {
    if (isReturn(p))
    {
      seen[static_cast<std::size_t>(azimuthColumn(p, 360))] = true;
    }
  }
  int gap = 0;
  int widest = 0;
  for (std::size_t i = 0; i < 2 * seen.size(); ++i)
  {
    gap = seen[i % seen.size()] ? 0 : gap + 1;
    widest = std::max(widest, gap);
  }
  return 2 * M_PI * (widest < min_gap ? 1.0 : 1.0 - std::min(widest, 360) / 360.0);
}

/** Whether the rings are those of a spinning lidar seen from beside it, as in points that were
 * moved to the vehicle's origin: they have no elevation of their own, but lie one over the other.
 * The few lines of a Livox and the rows of a camera are no such rings. */
bool areDisplacedRings(const std::vector<Ring>& rings, const std::vector<Eigen::Vector3f>& points)
{
  return rings.size() >= min_displaced_rings &&
         medianSpread(rings) <
             max_displaced_spread * (rings.back().elevation - rings.front().elevation) &&
         azimuthExtent(points) > M_PI;
}

/** Azimuth step and range noise along the rings. */
void measureAlongRings(const std::vector<Eigen::Vector3f>& points,
                       const std::vector<std::uint16_t>& numbers,
                       const std::vector<Ring>& rings,
                       ScanPattern& pattern)
{
  struct Place
  {
    float azimuth;
    float range;
  };
  std::vector<std::vector<Place>> places(rings.size());
  std::vector<int> place_of(65536, -1);
  const std::size_t stride = std::max<std::size_t>(1, rings.size() / examined_rings);
  for (std::size_t r = 0; r < rings.size(); r += stride)
  {
    place_of[rings[r].number] = static_cast<int>(r);
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const int r = place_of[numbers[i]];
    if (r >= 0 && isReturn(points[i]))
    {
      places[static_cast<std::size_t>(r)].push_back(
          {std::atan2(points[i].y(), points[i].x()), points[i].norm()});
    }
  }
  std::vector<float> steps;
  std::vector<float> bends;
  for (auto& ring : places)
  {
    std::sort(ring.begin(), ring.end(),
              [](const Place& a, const Place& b)
              { return a.azimuth < b.azimuth || (a.azimuth == b.azimuth && a.range < b.range); });
    for (std::size_t i = 1; i < ring.size(); ++i)
    {
      const float step = ring[i].azimuth - ring[i - 1].azimuth;
      if (step > 1e-5F)
      {
        steps.push_back(step);
      }
      if (i + 1 < ring.size())
      {
        bends.push_back(std::fabs(ring[i - 1].range - 2 * ring[i].range + ring[i + 1].range));
      }
    }
  }
  pattern.column_spacing = steps.empty() ? 0 : static_cast<double>(quantile(steps, 0.5));
  // The median of a normal error's magnitude is 0.674 sigma; three ranges are in each bend.
  pattern.range_noise =
      bends.empty() ? 0 : static_cast<double>(quantile(bends, 0.5)) / 0.674 / std::sqrt(6.0);
}

/** Field of view of the returns. */
void measureExtent(const std::vector<Eigen::Vector3f>& points, ScanPattern& pattern)
{
  std::vector<float> elevations;
  float farthest = 0;
  for (const Eigen::Vector3f& p : points)
  {
    if (isReturn(p))
    {
      elevations.push_back(elevationOf(p));
      const float squared = p.squaredNorm();
      farthest = std::isfinite(squared) ? std::max(farthest, squared) : farthest;
    }
  }
  pattern.returns = elevations.size();
  if (elevations.empty())
  {
    return;
  }
  pattern.max_range = std::sqrt(static_cast<double>(farthest));
  pattern.lowest = static_cast<double>(quantile(elevations, trimmed_share));
  pattern.highest = static_cast<double>(quantile(elevations, 1 - trimmed_share));
  pattern.azimuth_extent = azimuthExtent(points);
}
}  // namespace

double ScanPattern::spacing() const
{
  if (hasRings())
  {
    return std::max(ring_spacing, column_spacing);
  }
  const double solid = azimuth_extent * (std::sin(highest) - std::sin(lowest));
  return returns > 0 ? std::sqrt(solid / static_cast<double>(returns)) : 0;
}

std::vector<std::uint16_t> ringsOf(const std::vector<Eigen::Vector3f>& points,
                                   const std::vector<std::uint16_t>& given)
{
  const std::vector<Ring> recorded =
      given.size() == points.size() ? measureRings(points, given) : std::vector<Ring>();
  if (areRings(recorded))
  {
    return given;
  }
  std::vector<std::uint16_t> found = estimateRings(points);
  if (found.size() == points.size() && areRings(measureRings(points, found)))
  {
    return found;
  }
  return areDisplacedRings(recorded, points) ? given : std::vector<std::uint16_t>();
}

ScanPattern measureScanPattern(const Scan& scan)
{
  if (!scan.parts.empty())
  {
    return measureScanPattern(ownScan(scan));
  }
  ScanPattern pattern;
  measureExtent(scan.points, pattern);
  if (scan.time.size() == scan.size())
  {
    pattern.duration = timeExtent(scan.time).value_or(TimeExtent()).duration();
    pattern.point_times = pattern.duration > 0;
  }
  pattern.firing_order = inFiringOrder(scan.points);
  const std::vector<std::uint16_t> numbers = ringsOf(scan.points, scan.ring);
  if (numbers.empty())
  {
    return pattern;
  }
  pattern.ring_numbers = numbers == scan.ring;
  const std::vector<Ring> rings = measureRings(scan.points, numbers);
  for (const Ring& ring : rings)
  {
    pattern.rings.push_back(ring.elevation);
  }
  std::vector<float> steps = spacings(rings);
  pattern.ring_spacing = static_cast<double>(quantile(steps, 0.5));
  pattern.widest_spacing = static_cast<double>(quantile(steps, 0.9));
  measureAlongRings(scan.points, numbers, rings, pattern);
  return pattern;
}
}  // namespace dyslam
