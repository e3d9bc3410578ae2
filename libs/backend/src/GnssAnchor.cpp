// SPDX-License-Identifier: BSD-3-Clause
#include "GnssAnchor.h"

#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/mrpt/Geodesy.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

namespace dyslam
{
void GnssOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "use", use, {{"off", GnssUse::off}, {"align", GnssUse::align}, {"fuse", GnssUse::fuse}},
      "positions of a satellite receiver: off; align: find the pose of the map on the earth; "
      "fuse: and optimise the graph with them");
  visitor.real("distance", distance, 0, 1000,
               "distance travelled between two positions that are used [m]");
  visitor.real("min_extent", min_extent, 1, 1e5,
               "extent of the positions below which they are not used [m]");
  visitor.real("default_sigma", default_sigma, 1e-3, 1000,
               "horizontal standard deviation where the receiver states none; vertical: twice [m]");
  visitor.real("min_sigma", min_sigma, 1e-3, 1000, "smallest standard deviation believed [m]");
  visitor.real("correlation_time", correlation_time, 0, 1e4,
               "how long the receiver's errors last: positions within this time count as one [s]");
  visitor.degrees("tilt_sigma_deg", tilt_sigma, 0.01, 90,
                  "standard deviation of the map's z axis from the vertical [deg]");
}

void GnssAnchor::add(const std::vector<GnssFix>& fixes)
{
  if (options_.use == GnssUse::off)
  {
    return;
  }
  // Without a fix, receivers give positions of zeros or NaN.
  std::copy_if(
      fixes.begin(), fixes.end(), std::back_inserter(fixes_),
      [](const GnssFix& fix)
      { return std::isfinite(fix.stamp) && isOnEarth(fix.position) && fix.antenna.allFinite(); });
}

Eigen::Vector3d GnssAnchor::inMap(const FactorGraph& graph, const Used& used) const
{
  return graph.pose(Key::ego(used.keyframe)) * used.antenna;
}

Eigen::Vector3d GnssAnchor::errorOf(const FactorGraph& graph, const Used& used) const
{
  return graph.pose(Key::georeference()) * inMap(graph, used) - used.position;
}

/** Extent of the antenna's path by the trajectory [m]; single positions may be far off. */
double GnssAnchor::extent(const FactorGraph& graph) const
{
  double largest = 0;
  for (const Used& used : used_)
  {
    largest = std::max(largest, (inMap(graph, used) - inMap(graph, used_.front())).norm());
  }
  return largest;
}

/** Least extent of the positions that shows the heading [m]. The median sigma counts: without
 * enough satellites, as in a tunnel, a receiver may state kilometres. */
double GnssAnchor::neededExtent() const
{
  if (used_.empty())
  {
    return options_.min_extent;
  }
  constexpr double sigmas_of_extent = 5;
  std::vector<double> sigmas;
  for (const Used& used : used_)
  {
    sigmas.push_back(used.horizontal_sigma);
  }
  return std::max(options_.min_extent, sigmas_of_extent * upperMedian(sigmas));
}

/** Positions with correlated errors share the information of one. A pause, however long, counts as
 * one correlation time: it has no positions. */
double GnssAnchor::informationShare() const
{
  if (options_.correlation_time <= 0)
  {
    return 1;
  }
  double duration = used_.back().stamp - used_.front().stamp;
  for (std::size_t i = 1; i < used_.size(); ++i)
  {
    const double pause = used_[i].stamp - used_[i - 1].stamp;
    duration -= std::max(0.0, pause - options_.correlation_time);
  }
  const double independent = 1 + duration / options_.correlation_time;
  return std::min(1.0, independent / static_cast<double>(used_.size()));
}

void GnssAnchor::select(const FactorGraph& graph, const VehicleAt& vehicle_at)
{
  used_.clear();
  std::optional<Eigen::Vector3d> last;
  for (const GnssFix& fix : fixes_)
  {
    const auto vehicle = vehicle_at(fix.stamp);
    if (!vehicle)
    {
      continue;
    }
    Used used;
    used.keyframe = vehicle->keyframe;
    used.antenna = vehicle->T_keyframe_vehicle * fix.antenna;
    const Eigen::Vector3d place = inMap(graph, used);
    if (last && (place - *last).norm() < options_.distance)
    {
      continue;
    }
    last = place;
    if (used_.empty())
    {
      origin_ = fix.position;
    }
    const bool stated = fix.horizontal_sigma > 0 && fix.vertical_sigma > 0 &&
                        std::isfinite(fix.horizontal_sigma + fix.vertical_sigma);
    used.position = toEnu(fix.position, origin_);
    used.horizontal_sigma =
        std::max(options_.min_sigma, stated ? fix.horizontal_sigma : options_.default_sigma);
    used.vertical_sigma =
        std::max(options_.min_sigma, stated ? fix.vertical_sigma : 2 * options_.default_sigma);
    used.stamp = fix.stamp;
    used_.push_back(used);
  }
}

/** Pose of the map, by yaw and translation that align the trajectory with the positions: weighted
 * least squares, with weights that fall with the distance, so that outliers have little effect. */
Pose GnssAnchor::initialPose(const FactorGraph& graph) const
{
  constexpr int rounds = 20;
  std::vector<Eigen::Vector3d> in_map;
  for (const Used& used : used_)
  {
    in_map.push_back(inMap(graph, used));
  }
  std::vector<double> weights(used_.size(), 1);
  Pose T_enu_map = Pose::Identity();
  for (int round = 0; round < rounds; ++round)
  {
    Eigen::Vector3d mean_map = Eigen::Vector3d::Zero();
    Eigen::Vector3d mean_enu = Eigen::Vector3d::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < used_.size(); ++i)
    {
      mean_map += weights[i] * in_map[i];
      mean_enu += weights[i] * used_[i].position;
      sum += weights[i];
    }
    mean_map /= sum;
    mean_enu /= sum;
    double sine = 0;
    double cosine = 0;
    for (std::size_t i = 0; i < used_.size(); ++i)
    {
      const Eigen::Vector3d a = in_map[i] - mean_map;
      const Eigen::Vector3d b = used_[i].position - mean_enu;
      sine += weights[i] * (a.x() * b.y() - a.y() * b.x());
      cosine += weights[i] * (a.x() * b.x() + a.y() * b.y());
    }
    T_enu_map = poseFromYpr(0, 0, 0, std::atan2(sine, cosine), 0, 0);
    T_enu_map.translation() = mean_enu - T_enu_map.linear() * mean_map;
    std::vector<double> distances;
    for (std::size_t i = 0; i < used_.size(); ++i)
    {
      distances.push_back((T_enu_map * in_map[i] - used_[i].position).head<2>().norm());
    }
    std::vector<double> reordered = distances;
    const double scale = std::max(options_.min_sigma, upperMedian(reordered));
    for (std::size_t i = 0; i < used_.size(); ++i)
    {
      weights[i] = 1 / (1 + std::pow(distances[i] / scale, 2));
    }
  }
  return T_enu_map;
}

bool GnssAnchor::addTo(FactorGraph& graph, const VehicleAt& vehicle_at)
{
  constexpr std::size_t least = 3;
  if (fixes_.empty())
  {
    return false;
  }
  select(graph, vehicle_at);
  const double needed = neededExtent();
  if (used_.size() < least || extent(graph) < needed)
  {
    warn("the positions of the satellite receiver are not used: " +
         counted(used_.size(), "position") + " at scans, within " +
         std::to_string(used_.empty() ? 0 : std::lround(extent(graph))) + " m; " +
         std::to_string(least) + " that are spread over " + std::to_string(std::lround(needed)) +
         " m are needed to place the map on the earth");
    return false;
  }
  graph.addPose(Key::georeference(), initialPose(graph));
  const double share = informationShare();
  const double tilt_information =
      1 / (options_.tilt_sigma * options_.tilt_sigma * static_cast<double>(used_.size()));
  for (const Used& used : used_)
  {
    Matrix6 information = Matrix6::Identity();
    information(0, 0) = information(1, 1) = share / std::pow(used.horizontal_sigma, 2);
    information(2, 2) = share / std::pow(used.vertical_sigma, 2);
    information(3, 3) = information(4, 4) = tilt_information;
    graph.add(
        std::make_unique<GnssFactor>(used.keyframe, used.position, used.antenna, information));
  }
  return true;
}

bool GnssAnchor::fits(const FactorGraph& graph, double drift) const
{
  constexpr double most_sigmas = 3;
  constexpr double tolerance = 0.5;  // for an inaccurate antenna position [m]
  const double allowed = tolerance + drift * extent(graph);
  const double scale = most_sigmas / std::sqrt(informationShare());
  const auto fitting = std::count_if(
      used_.begin(), used_.end(),
      [&](const Used& used)
      { return errorOf(graph, used).head<2>().norm() < allowed + scale * used.horizontal_sigma; });
  return 2 * static_cast<std::size_t>(fitting) > used_.size();
}

Georeference GnssAnchor::georeference(const FactorGraph& graph) const
{
  Georeference result;
  result.origin = origin_;
  result.T_enu_map = graph.pose(Key::georeference());
  result.epsg = toUtm(fromEnu(result.T_enu_map.translation(), origin_)).epsg();
  result.fixes = used_.size();
  for (const Used& used : used_)
  {
    const Eigen::Vector3d error = errorOf(graph, used);
    const auto count = static_cast<double>(used_.size());
    result.horizontal_rmse += error.head<2>().squaredNorm() / count;
    result.vertical_rmse += error.z() * error.z() / count;
  }
  result.horizontal_rmse = std::sqrt(result.horizontal_rmse);
  result.vertical_rmse = std::sqrt(result.vertical_rmse);
  return result;
}

void GnssAnchor::exchangeState(StateArchive& archive)
{
  archive(fixes_);
}
}  // namespace dyslam
