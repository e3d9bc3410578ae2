// SPDX-License-Identifier: BSD-3-Clause
#include "RunAnchor.h"

#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/base/Angle.h>
#include <dyslam/mrpt/Geodesy.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "GravityAnchor.h"

namespace dyslam
{
namespace
{
/** Error of a receiver that lasts for a whole run, and that its RMSE therefore does not show,
 * horizontally; vertically twice [m]. */
constexpr double lasting_error = 2;
constexpr double map_tilt_sigma = 5 * radians_per_degree;  // as the default of GnssOptions
constexpr double least_tilt_sigma = 0.01 * radians_per_degree;
}  // namespace

RunAnchor::RunAnchor(const FactorGraph& graph, const RunReferences& references)
    : references_(references)
{
  for (std::size_t k = 0; graph.contains(Key::ego(k)); ++k)
  {
    poses_.push_back(graph.pose(Key::ego(k)));
  }
  if (references_.georeference)
  {
    takePositions(graph);
  }
  if (references_.gravity)
  {
    takeDirections(graph);
  }
}

void RunAnchor::takePositions(const FactorGraph& graph)
{
  if (graph.contains(Key::georeference()))
  {
    for (const FactorGraph::FactorId id : graph.factorsOf(Key::georeference()))
    {
      const auto& factor = static_cast<const GnssFactor&>(graph.factor(id));
      positions_.push_back({static_cast<std::size_t>(factor.keys()[0].index),
                            factor.measurement().translation(), factor.antenna(),
                            factor.information()});
    }
    return;
  }
  const auto count = static_cast<double>(poses_.size());
  const double vertical_sigma =
      std::hypot(references_.georeference->vertical_rmse, 2 * lasting_error);
  Matrix6 information = Matrix6::Identity();
  information(0, 0) = information(1, 1) = 1 / (std::pow(positionSigma(), 2) * count);
  information(2, 2) = 1 / (std::pow(vertical_sigma, 2) * count);
  information(3, 3) = information(4, 4) = 1 / (map_tilt_sigma * map_tilt_sigma * count);
  upwards_ = references_.georeference->T_enu_map.linear().transpose() * Eigen::Vector3d::UnitZ();
  for (std::size_t k = 0; k < poses_.size(); ++k)
  {
    positions_.push_back({k, references_.georeference->T_enu_map * poses_[k].translation(),
                          Eigen::Vector3d::Zero(), information});
  }
}

void RunAnchor::takeDirections(const FactorGraph& graph)
{
  if (graph.contains(Key::vertical()) && graph.contains(Key::accelerometerBias()))
  {
    for (const FactorGraph::FactorId id : graph.factorsOf(Key::vertical()))
    {
      const auto& factor = static_cast<const GravityFactor&>(graph.factor(id));
      directions_.push_back({static_cast<std::size_t>(factor.keys()[0].index), factor.upwards(),
                             factor.information()});
    }
    bias_ = graph.vector(Key::accelerometerBias());
    return;
  }
  const double sigma = std::max(least_tilt_sigma, references_.gravity->tilt_sigma);
  Matrix6 information = Matrix6::Identity();
  information(0, 0) = information(1, 1) = 1 / (sigma * sigma * static_cast<double>(poses_.size()));
  for (std::size_t k = 0; k < poses_.size(); ++k)
  {
    directions_.push_back(
        {k, standard_gravity * (poses_[k].linear().transpose() * references_.gravity->up_map),
         information});
  }
}

Pose RunAnchor::onEarth(std::size_t keyframe, const GeodeticPosition& origin) const
{
  return enuInEnu(references_.georeference->origin, origin) * references_.georeference->T_enu_map *
         poses_[keyframe];
}

double RunAnchor::positionSigma() const
{
  return std::hypot(references_.georeference->horizontal_rmse, lasting_error);
}

Eigen::Vector3d RunAnchor::upIn(const Pose& T_map_vehicle) const
{
  return T_map_vehicle.linear() * poses_[middle()].linear().transpose() *
         references_.gravity->up_map;
}

void RunAnchor::addPositions(FactorGraph& merged,
                             std::size_t first,
                             const GeodeticPosition& origin) const
{
  if (!merged.contains(Key::georeference()))
  {
    merged.addPose(Key::georeference(),
                   orthonormalised(onEarth(middle(), origin) *
                                   merged.pose(Key::ego(first + middle())).inverse()));
  }
  const Pose T_enu_own = enuInEnu(references_.georeference->origin, origin);
  const Eigen::Vector3d upwards = merged.pose(Key::ego(first + middle())).linear() *
                                  poses_[middle()].linear().transpose() * upwards_;
  for (const Position& p : positions_)
  {
    merged.add(std::make_unique<GnssFactor>(first + p.keyframe, T_enu_own * p.position, p.antenna,
                                            p.information, upwards));
  }
}

void RunAnchor::addVertical(FactorGraph& merged, std::size_t first, std::size_t run) const
{
  if (!merged.contains(Key::vertical()))
  {
    merged.addPose(Key::vertical(), levellingOf(upIn(merged.pose(Key::ego(first + middle())))));
  }
  const Key bias = Key::accelerometerBias(run);
  merged.addVector(bias, bias_.value_or(Vector6::Zero()));
  merged.setFixed(bias, !bias_);
  for (const Direction& d : directions_)
  {
    merged.add(std::make_unique<GravityFactor>(first + d.keyframe, d.upwards, d.information, bias));
  }
}

ReferenceFit RunAnchor::fit(const std::vector<Pose>& merged,
                            const std::optional<Georeference>& georeference,
                            const std::optional<Gravity>& gravity) const
{
  ReferenceFit fit;
  if (georeference && references_.georeference)
  {
    const Pose T_enu_own = enuInEnu(references_.georeference->origin, georeference->origin);
    double horizontal = 0;
    double vertical = 0;
    for (const Position& p : positions_)
    {
      const Eigen::Vector3d error =
          georeference->T_enu_map * merged[p.keyframe] * p.antenna - T_enu_own * p.position;
      horizontal += error.head<2>().squaredNorm() / static_cast<double>(positions_.size());
      vertical += error.z() * error.z() / static_cast<double>(positions_.size());
    }
    const Georeference& own = *references_.georeference;
    fit.positions = own.fixes;
    fit.horizontal_rmse = std::sqrt(horizontal);
    fit.vertical_rmse = std::sqrt(vertical);
    if (!own.fused)  // the errors are those of the map as a whole
    {
      fit.horizontal_rmse = std::hypot(fit.horizontal_rmse, own.horizontal_rmse);
      fit.vertical_rmse = std::hypot(fit.vertical_rmse, own.vertical_rmse);
    }
  }
  if (gravity && references_.gravity)
  {
    const double cosine = upIn(merged[middle()]).normalized().dot(gravity->up_map);
    fit.directions = references_.gravity->directions;
    fit.up_error = std::acos(std::clamp(cosine, -1.0, 1.0));
    fit.up_sigma = references_.gravity->tilt_sigma;
  }
  return fit;
}
}  // namespace dyslam
