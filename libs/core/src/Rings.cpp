// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/core/FiringOrder.h>
#include <dyslam/core/Rings.h>
#include <dyslam/core/Scan.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dyslam
{
namespace
{
constexpr auto pi = static_cast<float>(M_PI);
constexpr std::size_t most_rings = 160;
constexpr std::size_t fewest_rings = 4;
/** Rings found by elevation: least share of empty elevations, largest share of points there. */
constexpr float min_gap_share = 0.25F;
constexpr float max_outside_share = 0.01F;
/** Nearer points may be no returns [m]: drivers put lasers without a return at the sensor. */
constexpr float nearest_return = 1;

/** Points that show a ring: returns; only the far ones if these are the majority. */
std::vector<std::uint32_t> clearReturns(const std::vector<Eigen::Vector3f>& points)
{
  std::vector<std::uint32_t> returns;
  std::vector<std::uint32_t> far;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (isReturn(points[i]))
    {
      returns.push_back(static_cast<std::uint32_t>(i));
      if (points[i].squaredNorm() >= nearest_return * nearest_return)
      {
        far.push_back(returns.back());
      }
    }
  }
  return 2 * far.size() > returns.size() ? far : returns;
}

/** Positions where a new ring begins if the azimuth wraps at `seam`. */
std::vector<std::size_t> ringStarts(const std::vector<std::uint32_t>& returns,
                                    const std::vector<float>& azimuths,
                                    float seam)
{
  std::vector<std::size_t> starts{0};
  const auto cut = [&](std::size_t i)
  {
    const float a = (azimuths[i] - seam) / (2 * pi);
    return a - std::floor(a);
  };
  for (std::size_t i = 1; i < returns.size(); ++i)
  {
    if (std::fabs(cut(i) - cut(i - 1)) > 0.5F)
    {
      starts.push_back(i);
    }
  }
  return starts;
}

/** Ring of each return, by first occurrence; empty if the order of the file shows no rings. */
std::vector<std::uint16_t> ringsByOrder(const std::vector<std::uint32_t>& returns,
                                        const std::vector<float>& azimuths,
                                        const std::vector<float>& elevations)
{
  std::vector<std::size_t> best;
  float best_step = 0;
  for (const float seam : {0.0F, pi})
  {
    std::vector<std::size_t> starts = ringStarts(returns, azimuths, seam);
    if (starts.size() < fewest_rings || starts.size() > most_rings)
    {
      continue;
    }
    // At the true seam the beam changes too, so the elevation steps there.
    std::vector<float> steps;
    for (std::size_t s = 1; s < starts.size(); ++s)
    {
      steps.push_back(std::fabs(elevations[starts[s]] - elevations[starts[s] - 1]));
    }
    const float step = upperMedian(steps);
    if (step > best_step)
    {
      best_step = step;
      best = std::move(starts);
    }
  }
  std::vector<std::uint16_t> rings;
  if (best_step < 0.001F)
  {
    return rings;
  }
  rings.resize(returns.size());
  for (std::size_t s = 0; s < best.size(); ++s)
  {
    const std::size_t end = s + 1 < best.size() ? best[s + 1] : returns.size();
    std::fill(rings.begin() + static_cast<std::ptrdiff_t>(best[s]),
              rings.begin() + static_cast<std::ptrdiff_t>(end), static_cast<std::uint16_t>(s));
  }
  return rings;
}

/** Ring of each return from gaps in the histogram of elevations; empty if there are none. */
std::vector<std::uint16_t> ringsByElevation(const std::vector<float>& elevations)
{
  constexpr float bin = 0.05F * pi / 180;
  constexpr int bins = 3600;
  std::vector<std::uint32_t> histogram(bins, 0);
  const auto binOf = [](float e)
  { return std::clamp(static_cast<int>((e + pi / 2) / bin), 0, bins - 1); };
  for (const float e : elevations)
  {
    ++histogram[static_cast<std::size_t>(binOf(e))];
  }
  const auto enough = static_cast<std::uint32_t>(elevations.size() / 2000 + 1);
  std::vector<std::uint16_t> ring_of_bin(bins, 0);
  std::size_t rings = 0;
  std::size_t outside = 0;  // points between rings
  int first = bins;
  int last = 0;
  int occupied_bins = 0;
  bool inside = false;
  for (int b = 0; b < bins; ++b)
  {
    const std::uint32_t count = histogram[static_cast<std::size_t>(b)];
    const bool occupied = count >= enough;
    rings += occupied && !inside ? 1 : 0;
    inside = occupied;
    outside += occupied ? 0 : count;
    occupied_bins += occupied ? 1 : 0;
    first = occupied ? std::min(first, b) : first;
    last = occupied ? b : last;
    ring_of_bin[static_cast<std::size_t>(b)] =
        static_cast<std::uint16_t>(rings > 0 ? rings - 1 : 0);
  }
  std::vector<std::uint16_t> result;
  const int span = last - first + 1;
  const bool gaps =
      static_cast<float>(span - occupied_bins) >= min_gap_share * static_cast<float>(span) &&
      static_cast<float>(outside) <= max_outside_share * static_cast<float>(elevations.size());
  if (rings < fewest_rings || rings > most_rings || !gaps)
  {
    return result;
  }
  result.reserve(elevations.size());
  for (const float e : elevations)
  {
    result.push_back(ring_of_bin[static_cast<std::size_t>(binOf(e))]);
  }
  return result;
}

/** Renumbers rings so that the median elevation rises with the number. */
void sortRings(std::vector<std::uint16_t>& rings, const std::vector<float>& elevations)
{
  const std::size_t count = 1U + *std::max_element(rings.begin(), rings.end());
  std::vector<std::vector<float>> of_ring(count);
  for (std::size_t i = 0; i < rings.size(); ++i)
  {
    of_ring[rings[i]].push_back(elevations[i]);
  }
  std::vector<float> median(count);
  std::vector<std::uint16_t> order(count);
  for (std::size_t r = 0; r < count; ++r)
  {
    median[r] = of_ring[r].empty() ? 0 : upperMedian(of_ring[r]);
    order[r] = static_cast<std::uint16_t>(r);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint16_t a, std::uint16_t b) { return median[a] < median[b]; });
  std::vector<std::uint16_t> rank(count);
  for (std::size_t r = 0; r < count; ++r)
  {
    rank[order[r]] = static_cast<std::uint16_t>(r);
  }
  for (std::uint16_t& ring : rings)
  {
    ring = rank[ring];
  }
}
}  // namespace

int azimuthColumn(const Eigen::Vector3f& p, int cols)
{
  const float turns = 0.5F - std::atan2(p.y(), p.x()) / (2 * pi);
  const int col = static_cast<int>(turns * static_cast<float>(cols));
  return std::clamp(col, 0, cols - 1);
}

float elevationOf(const Eigen::Vector3f& p)
{
  return std::atan2(p.z(), std::hypot(p.x(), p.y()));
}

std::vector<std::uint16_t> estimateRings(const std::vector<Eigen::Vector3f>& points)
{
  const std::vector<std::uint32_t> returns = clearReturns(points);
  std::vector<float> azimuths;
  std::vector<float> elevations;
  for (const std::uint32_t i : returns)
  {
    azimuths.push_back(std::atan2(points[i].y(), points[i].x()));
    elevations.push_back(elevationOf(points[i]));
  }
  if (returns.empty())
  {
    return {};
  }
  std::vector<std::uint16_t> rings;
  if (!inFiringOrder(points))
  {
    rings = ringsByOrder(returns, azimuths, elevations);
  }
  if (rings.empty())
  {
    rings = ringsByElevation(elevations);
  }
  if (rings.empty())
  {
    return {};
  }
  sortRings(rings, elevations);
  std::vector<std::uint16_t> result(points.size(), rings.front());
  std::size_t next = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    next += next + 1 < returns.size() && returns[next + 1] <= i ? 1 : 0;
    result[i] = rings[next];
  }
  return result;
}
}  // namespace dyslam
