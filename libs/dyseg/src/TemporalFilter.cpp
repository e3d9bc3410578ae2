// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Scan.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/dyseg/TemporalFilter.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr std::uint64_t memory = 20;    // scans
constexpr std::uint64_t sweeping = 10;  // scans between removals of old cells
constexpr float least = 0.05F;          // probability; a single scan is limited to this

float logOdds(float probability)
{
  const float p = std::clamp(probability, least, 1 - least);
  return std::log(p / (1 - p));
}

/** Key of the cell of a position in units of cells. */
std::uint64_t cellKey(const Eigen::Vector3f& position)
{
  return voxelKey(voxelCell(position, 1));
}

/** Lowest height of the points in columns around each point's own, vehicle frame. */
std::vector<float> lowestAround(const std::vector<Eigen::Vector3f>& points, float cell_size)
{
  constexpr float empty = 1e9F;
  std::unordered_map<std::uint64_t, float> lowest;
  const auto column = [&](const Eigen::Vector3f& p, int dx, int dy)
  {
    return cellKey({p.x() / cell_size + static_cast<float>(dx),
                    p.y() / cell_size + static_cast<float>(dy), 0});
  };
  for (const auto& p : points)
  {
    if (p.allFinite())
    {
      auto& low = lowest.try_emplace(column(p, 0, 0), empty).first->second;
      low = std::min(low, p.z());
    }
  }
  std::unordered_map<std::uint64_t, float> around;
  std::vector<float> result(points.size(), empty);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (!points[i].allFinite())
    {
      continue;
    }
    const auto [known, is_new] = around.try_emplace(column(points[i], 0, 0), empty);
    for (int k = 0; is_new && k < 9; ++k)
    {
      const auto found = lowest.find(column(points[i], k % 3 - 1, k / 3 - 1));
      if (found != lowest.end())
      {
        known->second = std::min(known->second, found->second);
      }
    }
    result[i] = known->second;
  }
  return result;
}
}  // namespace

void TemporalFilterOptions::describe(OptionsVisitor& v)
{
  v.real("cell_size", cell_size, 0.05, 5, "side of the cells [m]");
  v.real("ground_clearance", ground_clearance, 0, 2,
         "points lower than this above the lowest nearby are unchanged [m]");
  v.real("decay", decay, 0, 1, "factor on a cell's log-odds per scan");
  v.real("share", share, 0, 1, "weight of a cell's past log-odds in those of its points");
  v.real("max_log_odds", max_log_odds, 0.1, 100,
         "limit of a cell's log-odds, positive and negative");
}

TemporalFilter::TemporalFilter(const TemporalFilterOptions& options) : options_(options)
{
  validate(options_, "dyseg_filter");
}

std::uint64_t TemporalFilter::keyOf(const Eigen::Vector3f& point) const
{
  return cellKey(point / static_cast<float>(options_.cell_size));
}

void TemporalFilter::apply(Frame& frame)
{
  ++scan_;
  const auto& points = frame.cloud.points;
  if (frame.moving_probability.size() != points.size())
  {
    return;
  }
  const auto low = lowestAround(points, static_cast<float>(options_.cell_size));
  const Eigen::Isometry3f T = frame.T_odom_vehicle.cast<float>();
  struct Sum
  {
    float log_odds = 0;
    float points = 0;
  };
  std::unordered_map<std::uint64_t, Sum> seen;
  const auto share = static_cast<float>(options_.share);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    float& probability = frame.moving_probability[i];
    if (!points[i].allFinite() ||
        points[i].z() < low[i] + static_cast<float>(options_.ground_clearance))
    {
      continue;
    }
    const float now = logOdds(probability);
    const auto key = keyOf(T * points[i]);
    auto& sum = seen[key];
    sum.log_odds += now;
    sum.points += 1;
    const auto known = cells_.find(key);
    if (known != cells_.end())
    {
      const auto age = static_cast<float>(scan_ - known->second.scan - 1);
      const float before =
          known->second.log_odds * std::pow(static_cast<float>(options_.decay), age);
      probability = 1 / (1 + std::exp(-(now + share * before)));
    }
  }
  const auto most = static_cast<float>(options_.max_log_odds);
  const auto decay = static_cast<float>(options_.decay);
  for (const auto& [key, sum] : seen)
  {
    auto& cell = cells_[key];
    const auto age = static_cast<float>(scan_ - cell.scan);
    const float kept = cell.log_odds * std::pow(decay, age);
    cell.log_odds = std::clamp(kept + sum.log_odds / sum.points, -most, most);
    cell.scan = scan_;
  }
  forgetOld();
}

void TemporalFilter::forgetOld()
{
  if (scan_ % sweeping != 0)
  {
    return;
  }
  for (auto i = cells_.begin(); i != cells_.end();)
  {
    i = i->second.scan + memory < scan_ ? cells_.erase(i) : std::next(i);
  }
}

void TemporalFilter::exchangeState(StateArchive& archive)
{
  archive(cells_, scan_);
}
}  // namespace dyslam
