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
#include <utility>

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
  visitor.real("drift", drift, 0, 1,
               "error of the trajectory between two positions as a fraction of the path, beyond "
               "which one of them is an outlier; 0: no search for outliers");
  visitor.degrees("tilt_sigma_deg", tilt_sigma, 0.01, 90,
                  "standard deviation of the map's z axis from the vertical [deg]");
}

namespace
{
constexpr std::size_t least_positions = 3;  //!< that place the map
constexpr double antenna_tolerance = 0.5;   //!< for an inaccurate position of the antenna [m]

/** A position, compared with the trajectory. */
struct ComparedPosition
{
  Eigen::Vector2d error;  //!< east, north [m]
  double sigma = 0;       //!< of each component, stated by the receiver [m]
  double path = 0;        //!< path of the antenna up to here [m]
};

/** Sigma of the errors' white part, from the differences of successive ones [m]. */
double whiteSigma(const std::vector<ComparedPosition>& positions)
{
  constexpr double median_of_difference = 1.665;  // of its length in the plane, for a sigma of 1
  std::vector<double> differences;
  for (std::size_t i = 1; i < positions.size(); ++i)
  {
    differences.push_back((positions[i].error - positions[i - 1].error).norm());
  }
  return upperMedian(differences) / median_of_difference;
}

/** Positions that agree with each other, in the order of time: those of the best sequence, in which
 * each position counts 1, and each jump costs a quarter of all positions. A jump is a difference of
 * two successive errors that neither noise nor drift explains. So a part with another error is left
 * out if it is short, and kept if it is long: then the trajectory may be wrong. It may be so after
 * a stretch without positions, too, as a tunnel; both ends of it agree. \return ascending indices
 */
std::vector<std::size_t> agreeingPositions(const std::vector<ComparedPosition>& positions,
                                           double drift)
{
  constexpr double most_sigmas = 3;
  constexpr double jump_share = 0.25;
  constexpr double least_cost = 3;
  constexpr double longest_gap = 50;  // path without positions on which they are compared [m]
  const std::size_t none = positions.size();
  const double white = whiteSigma(positions);
  const double jump_cost = std::max(least_cost, jump_share * static_cast<double>(none));
  std::vector<double> scores(none, 0);
  std::vector<std::size_t> previous(none, none);
  for (std::size_t i = 0; i < none; ++i)
  {
    const ComparedPosition& here = positions[i];
    double best = 0;
    // The score of j is at most j + 1: without outliers only the position before is compared.
    for (std::size_t j = i; j-- > 0 && best < static_cast<double>(j + 1);)
    {
      const ComparedPosition& before = positions[j];
      const double noise =
          most_sigmas * std::hypot(std::max(here.sigma, white), std::max(before.sigma, white));
      const double path = here.path - before.path;
      const bool is_after_gap = j + 1 == i && path > longest_gap;
      const bool agrees = is_after_gap || (here.error - before.error).norm() <=
                                              antenna_tolerance + drift * path + noise;
      const double score = scores[j] - (agrees ? 0 : jump_cost);
      if (score > best)
      {
        best = score;
        previous[i] = j;
      }
    }
    scores[i] = best + 1;
  }
  const auto last = std::max_element(scores.begin(), scores.end()) - scores.begin();
  std::vector<std::size_t> agreeing;
  for (auto i = static_cast<std::size_t>(last); i != none; i = previous[i])
  {
    agreeing.push_back(i);
  }
  std::reverse(agreeing.begin(), agreeing.end());
  return agreeing;
}
}  // namespace

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
    used.on_earth = fix.position;
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

/** Leaves out positions that jump against the trajectory, as in tunnels and near buildings, if they
 * are fewer than half; those whose stated sigma is large have little weight and stay. */
void GnssAnchor::leaveOutOutliers(const FactorGraph& graph)
{
  constexpr std::size_t least = 8;
  constexpr double usual_sigmas = 5;  // limit of the stated sigmas, as a multiple of their median
  if (used_.size() < least || options_.drift <= 0)
  {
    return;
  }
  const Pose T_enu_map = initialPose(graph);
  std::vector<double> sigmas;
  for (const Used& used : used_)
  {
    sigmas.push_back(used.horizontal_sigma);
  }
  const double largest_sigma = usual_sigmas * upperMedian(sigmas);
  std::vector<ComparedPosition> compared;
  std::vector<std::size_t> indices;
  double path = 0;
  for (std::size_t i = 0; i < used_.size(); ++i)
  {
    const Eigen::Vector3d place = inMap(graph, used_[i]);
    path += i == 0 ? 0 : (place - inMap(graph, used_[i - 1])).norm();
    if (used_[i].horizontal_sigma <= largest_sigma)
    {
      const Eigen::Vector2d error = (T_enu_map * place - used_[i].position).head<2>();
      compared.push_back({error, used_[i].horizontal_sigma, path});
      indices.push_back(i);
    }
  }
  const std::vector<std::size_t> agreeing = agreeingPositions(compared, options_.drift);
  const std::size_t left_out = compared.size() - agreeing.size();
  if (left_out == 0 || 2 * left_out >= compared.size())
  {
    return;  // if most contradict each other, fits() refuses them all
  }
  std::vector<bool> is_left_out(used_.size(), false);
  double largest = 0;
  for (std::size_t k = 0, next = 0; k < compared.size(); ++k)
  {
    const bool agrees = next < agreeing.size() && agreeing[next] == k;
    next += agrees ? 1 : 0;
    is_left_out[indices[k]] = !agrees;
    largest = agrees ? largest : std::max(largest, compared[k].error.norm());
  }
  warn(
      formatted("%zu of %zu positions of the satellite receiver jump against the trajectory, by "
                "up to %.0f m, and are left out, as those near buildings and in tunnels "
                "(gnss.drift=0 keeps them)",
                left_out, used_.size(), largest));
  std::vector<Used> kept;
  for (std::size_t i = 0; i < used_.size(); ++i)
  {
    if (!is_left_out[i])
    {
      kept.push_back(used_[i]);
    }
  }
  used_ = std::move(kept);
  origin_ = used_.front().on_earth;
  for (Used& used : used_)
  {
    used.position = toEnu(used.on_earth, origin_);
  }
}

bool GnssAnchor::addTo(FactorGraph& graph, const VehicleAt& vehicle_at)
{
  if (fixes_.empty())
  {
    return false;
  }
  select(graph, vehicle_at);
  leaveOutOutliers(graph);
  const double needed = neededExtent();
  if (used_.size() < least_positions || extent(graph) < needed)
  {
    warn("the positions of the satellite receiver are not used: " +
         counted(used_.size(), "position") + " at scans, within " +
         std::to_string(used_.empty() ? 0 : std::lround(extent(graph))) + " m; " +
         std::to_string(least_positions) + " that are spread over " +
         std::to_string(std::lround(needed)) + " m are needed to place the map on the earth");
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
  return fits(graph, graph.pose(Key::georeference()), drift);
}

bool GnssAnchor::fitsIfSwapped(const FactorGraph& graph,
                               const VehicleAt& vehicle_at,
                               double drift) const
{
  GnssAnchor swapped(options_);
  std::vector<GnssFix> fixes = fixes_;
  for (GnssFix& fix : fixes)
  {
    std::swap(fix.position.latitude, fix.position.longitude);
  }
  swapped.add(fixes);
  swapped.select(graph, vehicle_at);
  return swapped.used_.size() >= least_positions &&
         swapped.fits(graph, swapped.initialPose(graph), drift);
}

/** \param T_enu_map pose of the map on the earth */
bool GnssAnchor::fits(const FactorGraph& graph, const Pose& T_enu_map, double drift) const
{
  constexpr double most_sigmas = 3;
  const double allowed = antenna_tolerance + drift * extent(graph);
  const double scale = most_sigmas / std::sqrt(informationShare());
  const auto fitting =
      std::count_if(used_.begin(), used_.end(),
                    [&](const Used& used)
                    {
                      const Eigen::Vector3d error = T_enu_map * inMap(graph, used) - used.position;
                      return error.head<2>().norm() < allowed + scale * used.horizontal_sigma;
                    });
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
