// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Parallel.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/base/Statistics.h>
#include <dyslam/core/NeighbourSearch.h>
#include <dyslam/eval/MapDistance.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

namespace dyslam
{
namespace
{
std::vector<float> distancesFrom(const KdTree& tree,
                                 const std::vector<Eigen::Vector3f>& points,
                                 ThreadPool& pool)
{
  constexpr std::size_t chunk_size = 10000;
  std::vector<float> distances(points.size(), std::numeric_limits<float>::quiet_NaN());
  pool.forChunks(points.size(), chunk_size,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     Neighbour nearest;
                     if (points[i].allFinite() && tree.nearest(points[i], nearest))
                     {
                       distances[i] = std::sqrt(nearest.squared_distance);
                     }
                   }
                 });
  return distances;
}

DistanceSummary distanceSummary(const std::vector<float>& distances)
{
  std::vector<double> values;
  values.reserve(distances.size());
  std::copy_if(distances.begin(), distances.end(), std::back_inserter(values),
               [](float distance) { return std::isfinite(distance); });
  DistanceSummary summary;
  if (values.empty())
  {
    return summary;
  }
  const Statistics statistics = statisticsOf(values);
  summary.count = statistics.count;
  summary.mean = statistics.mean;
  summary.median = statistics.median;
  summary.rmse = statistics.rmse;
  summary.max = statistics.max;
  for (std::size_t i = 0; i < summary.shares.size(); ++i)
  {
    // As float like the distances, so that a distance of 0.1 m counts as within 0.1 m.
    const auto limit = static_cast<double>(static_cast<float>(DistanceSummary::limits[i]));
    const auto within =
        std::count_if(values.begin(), values.end(), [limit](double v) { return v <= limit; });
    summary.shares[i] = static_cast<double>(within) / static_cast<double>(values.size());
  }
  constexpr double most = 0.95;
  summary.quantile95 = quantile(values, most);
  return summary;
}
}  // namespace

MapDistance mapDistance(const std::vector<Eigen::Vector3f>& reference,
                        const std::vector<Eigen::Vector3f>& estimate,
                        int threads)
{
  const KdTree of_reference(reference);
  const KdTree of_estimate(estimate);
  if (of_reference.size() == 0 || of_estimate.size() == 0)
  {
    throw std::invalid_argument("mapDistance: a cloud without points");
  }
  ThreadPool pool(threads);
  MapDistance result;
  result.of_estimate = distancesFrom(of_reference, estimate, pool);
  result.estimate = distanceSummary(result.of_estimate);
  result.reference = distanceSummary(distancesFrom(of_estimate, reference, pool));
  return result;
}
}  // namespace dyslam
