// SPDX-License-Identifier: BSD-3-Clause
// Satellite positions and verticals in a merge of runs.
#include <dyslam/base/Quantile.h>
#include <dyslam/mrpt/Geodesy.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "GravityAnchor.h"
#include "RunMergerState.h"

namespace dyslam
{
namespace
{
/** Horizontal distance that the accuracies of two runs' satellite positions explain [m]. */
double toleratedDistance(const RunAnchor& a, const RunAnchor& b)
{
  constexpr double most_sigmas = 3;
  return most_sigmas * std::hypot(a.positionSigma(), b.positionSigma());
}

/** Positions of the keyframes by the run alone, east-north-up of `origin` [m]. */
std::vector<Eigen::Vector3d> positionsOnEarth(const RunAnchor& run, const GeodeticPosition& origin)
{
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t k = 0; k < run.keyframes(); ++k)
  {
    positions.emplace_back(run.onEarth(k, origin).translation());
  }
  return positions;
}

double horizontalDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  return (a - b).head<2>().norm();
}

/** Rotates the merged map so that its z axis is vertical. \pre merge.gravity */
void level(RunMerge& merge)
{
  const Pose T_level_map = levellingOf(merge.gravity->up_map);
  for (std::vector<Pose>& poses : merge.poses)
  {
    for (Pose& pose : poses)
    {
      pose = orthonormalised(T_level_map * pose);
    }
  }
  if (merge.georeference)
  {
    merge.georeference->T_enu_map =
        orthonormalised(merge.georeference->T_enu_map * T_level_map.inverse());
  }
  merge.gravity->up_map = Eigen::Vector3d::UnitZ();
  merge.gravity->levelled = true;
}
}  // namespace

const RunAnchor* RunMerger::State::firstOnEarth() const
{
  const auto found =
      std::find_if(runs.begin(), runs.end(),
                   [](const Run& run) { return run.joined && run.anchor.georeference(); });
  return found != runs.end() ? &found->anchor : nullptr;
}

RunMerger::State::Seeds RunMerger::State::findSeeds(std::size_t a, std::size_t b, bool nearby)
{
  const RunAnchor& older = runs[a].anchor;
  const RunAnchor& newer = runs[b].anchor;
  NearKeyframes near;
  if (nearby && older.georeference() && newer.georeference())
  {
    const GeodeticPosition& origin = older.georeference()->origin;
    const double limit = config.loops.search_radius + toleratedDistance(older, newer);
    near = [&, limit, of_older = positionsOnEarth(older, origin),
            of_newer = positionsOnEarth(newer, origin)](std::size_t i, std::size_t k)
    {
      return horizontalDistance(of_older[i - runs[a].range.begin],
                                of_newer[k - runs[b].range.begin]) < limit;
    };
  }
  SimilarLoops similar = finder.byAppearance(runs[a].range, runs[b].range, near);
  return {a, b, std::move(similar.accepted), similar.fitting, near != nullptr};
}

std::optional<GnssContradiction> RunMerger::State::contradictionOf(const Placement& placement) const
{
  constexpr double usual_drift = 0.05;  // fraction of the distance from a run with positions
  const Run& run = runs[placement.run];
  const RunAnchor* first = firstOnEarth();
  if (first == nullptr || !run.anchor.georeference() || placement.loops.empty())
  {
    return std::nullopt;
  }
  const GeodeticPosition& origin = first->georeference()->origin;
  std::vector<double> distances;
  for (const Loop& loop : placement.loops)
  {
    const bool is_newer = run.range.contains(loop.to);
    const Pose T_joined_run = is_newer ? loop.T_from_to : loop.T_from_to.inverse();
    const Eigen::Vector3d by_loop = *T_enu_map *
                                    keyframes[is_newer ? loop.from : loop.to].T_map_vehicle *
                                    T_joined_run.translation();
    const Eigen::Vector3d by_gnss =
        run.anchor.onEarth((is_newer ? loop.to : loop.from) - run.range.begin, origin)
            .translation();
    distances.push_back(horizontalDistance(by_loop, by_gnss));
  }
  const Loop& seed = placement.loops.front();
  const Eigen::Vector3d at =
      keyframes[run.range.contains(seed.to) ? seed.from : seed.to].T_map_vehicle.translation();
  std::pair<double, std::size_t> nearest(std::numeric_limits<double>::infinity(), 0);
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    for (std::size_t k = runs[r].range.begin;
         runs[r].joined && runs[r].anchor.georeference() && k < runs[r].range.end; ++k)
    {
      const double distance = (keyframes[k].T_map_vehicle.translation() - at).norm();
      nearest = std::min(nearest, std::make_pair(distance, r));
    }
  }
  const double tolerated =
      toleratedDistance(runs[nearest.second].anchor, run.anchor) + usual_drift * nearest.first;
  const double median = upperMedian(distances);
  if (median <= tolerated)
  {
    return std::nullopt;
  }
  return GnssContradiction{nearest.second, median, tolerated};
}

std::optional<double> RunMerger::State::distanceOnEarth(std::size_t run) const
{
  const RunAnchor& own = runs[run].anchor;
  if (!own.georeference() || firstOnEarth() == nullptr)
  {
    return std::nullopt;
  }
  const GeodeticPosition& origin = own.georeference()->origin;
  const std::vector<Eigen::Vector3d> own_positions = positionsOnEarth(own, origin);
  double least = std::numeric_limits<double>::infinity();
  for (const Run& other : runs)
  {
    if (!other.joined || !other.anchor.georeference())
    {
      continue;
    }
    for (const Eigen::Vector3d& there : positionsOnEarth(other.anchor, origin))
    {
      for (const Eigen::Vector3d& here : own_positions)
      {
        least = std::min(least, horizontalDistance(here, there));
      }
    }
  }
  return least;
}

void RunMerger::State::addReferences(FactorGraph& graph) const
{
  const RunAnchor* on_earth = firstOnEarth();
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    const RunAnchor& anchor = runs[r].anchor;
    if (runs[r].joined && anchor.georeference())
    {
      anchor.addPositions(graph, runs[r].range.begin, on_earth->georeference()->origin);
    }
    if (runs[r].joined && anchor.gravity())
    {
      anchor.addVertical(graph, runs[r].range.begin, r);
    }
  }
}

Georeference RunMerger::State::georeferenceOf(const RunMerge& merge) const
{
  Georeference result;
  result.origin = firstOnEarth()->georeference()->origin;
  result.T_enu_map = *T_enu_map;
  result.epsg = toUtm(fromEnu(T_enu_map->translation(), result.origin)).epsg();
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!runs[r].joined || !runs[r].anchor.georeference())
    {
      continue;
    }
    const ReferenceFit fit = runs[r].anchor.fit(merge.poses[r], result, {});
    const auto count = static_cast<double>(fit.positions);
    result.fixes += fit.positions;
    result.horizontal_rmse += count * fit.horizontal_rmse * fit.horizontal_rmse;
    result.vertical_rmse += count * fit.vertical_rmse * fit.vertical_rmse;
    result.fused = result.fused || runs[r].anchor.georeference()->fused;
  }
  const double all = std::max(1.0, static_cast<double>(result.fixes));
  result.horizontal_rmse = std::sqrt(result.horizontal_rmse / all);
  result.vertical_rmse = std::sqrt(result.vertical_rmse / all);
  return result;
}

Gravity RunMerger::State::gravityOf(const RunMerge& merge) const
{
  Gravity result;
  result.up_map = T_level_map->linear().transpose() * Eigen::Vector3d::UnitZ();
  result.tilt = std::acos(std::clamp(result.up_map.z(), -1.0, 1.0));
  double information = 0;
  double squared = 0;
  std::size_t verticals = 0;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!runs[r].joined || !runs[r].anchor.gravity())
    {
      continue;
    }
    const ReferenceFit fit = runs[r].anchor.fit(merge.poses[r], {}, result);
    information += 1 / std::max(1e-12, fit.up_sigma * fit.up_sigma);
    squared += *fit.up_error * *fit.up_error;
    result.directions += fit.directions;
    result.fused = result.fused || runs[r].anchor.gravity()->fused;
    ++verticals;
  }
  result.tilt_sigma = 1 / std::sqrt(information);
  result.rmse = std::sqrt(squared / static_cast<double>(verticals));
  return result;
}

void RunMerger::State::fillReferences(RunMerge& merge) const
{
  if (T_enu_map)
  {
    merge.georeference = georeferenceOf(merge);
  }
  if (T_level_map)
  {
    merge.gravity = gravityOf(merge);
  }
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    merge.fits.push_back(runs[r].joined
                             ? runs[r].anchor.fit(merge.poses[r], merge.georeference, merge.gravity)
                             : ReferenceFit());
  }
  const std::optional<Gravity>& of_first = runs.front().anchor.gravity();
  if (merge.gravity && (config.merge.level_map || (of_first && of_first->levelled)))
  {
    level(merge);
  }
}
}  // namespace dyslam
