// SPDX-License-Identifier: BSD-3-Clause
#include "DyloScanMatcher.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/core/ScanParts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "CloudCheck.h"

namespace dyslam
{
namespace
{
constexpr std::size_t fewest_matches = 50;

/** The network with the weights of the options. \throws UserError. */
DyloMatcher matcherFor(const DyloOptions& options)
{
  const char* setting = "dylo.weights";
  const std::string file = findGivenOrShared(options.weights, "models", ".safetensors", setting);
  return namingSetting(setting, file, [&] { return DyloMatcher(file, options.threads); });
}
}  // namespace

DyloScanMatcher::DyloScanMatcher(const DyloOptions& options)
    : options_(options), matcher_(matcherFor(options))
{
}

std::string DyloScanMatcher::extract(const Frame& frame)
{
  confidence_.clear();
  if (const std::string trouble = reasonUnusable(frame); !trouble.empty())
  {
    return trouble;
  }
  T_vehicle_lidar_ = frame.scan.T_vehicle_lidar;
  const Eigen::Isometry3f T_lidar_vehicle = T_vehicle_lidar_.inverse().cast<float>();
  points_.resize(frame.cloud.size());
  std::transform(frame.cloud.points.begin(), frame.cloud.points.end(), points_.begin(),
                 [&](const Eigen::Vector3f& p) { return T_lidar_vehicle * p; });
  // The network's images are of one lidar.
  std::fill(points_.begin() + static_cast<std::ptrdiff_t>(ownPoints(frame.scan, frame.cloud)),
            points_.end(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  // Points that are known to move are not passed to the network.
  weights_ = pointWeights(frame);
  for (std::size_t i = 0; i < weights_.size(); ++i)
  {
    if (weights_[i] < 0.5F)
    {
      points_[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    }
  }
  const Pose T_sweep = T_vehicle_lidar_.inverse() * frame.cloud.T_sweep * T_vehicle_lidar_;
  const std::size_t usable = options_.deskew ? matcher_.setCurrent(points_, frame.cloud.phase,
                                                                   T_sweep, frame.cloud.phase_unit)
                                             : matcher_.setCurrent(points_);
  return usable < fewest_matches ? "only " + counted(usable, "point") + " within range"
                                 : std::string();
}

std::string DyloScanMatcher::doubts(const DyloMatch& match) const
{
  if (match.matched < fewest_matches)
  {
    return "only " + std::to_string(match.matched) + (match.matched == 1 ? " match" : " matches");
  }
  const double share = static_cast<double>(match.inliers) / static_cast<double>(match.sampled);
  if (share < options_.min_inlier_share)
  {
    return formatted("only %.0f %% of the points are inliers", 100 * share);
  }
  if (match.last_step > options_.max_last_step)
  {
    return formatted("not converged: the last step was %.2f m", match.last_step);
  }
  const double far = match.T_reference_current.translation().norm();
  const double turned = rotationAngle(match.T_reference_current);
  if (!(far <= options_.max_translation) || !(turned <= options_.max_rotation))
  {
    return formatted("a motion of %.1f m and %.0f degrees is implausible", far,
                     turned * 180 / M_PI);
  }
  return {};
}

MotionEstimate DyloScanMatcher::align(const Pose& T_reference_current_guess)
{
  const Pose T_lidar_vehicle = T_vehicle_lidar_.inverse();
  const Pose predicted = T_lidar_vehicle * T_reference_current_guess * T_vehicle_lidar_;
  const Pose start = options_.start == DyloStart::prediction ? predicted : Pose::Identity();
  DyloPrior prior;
  prior.T_reference_current = predicted;
  const Matrix6 to_vehicle = adjointSE3(T_vehicle_lidar_);
  prior.information = to_vehicle.transpose() * guessInformation() * to_vehicle;
  prior.points_per_measurement = options_.points_per_measurement;
  const bool has_prior = options_.prior && !guessInformation().isZero();
  const DyloMatch match =
      matcher_.match(start, referenceIsPrevious(), has_prior ? &prior : nullptr);
  MotionEstimate estimate;
  estimate.T_previous_current =
      orthonormalised(T_vehicle_lidar_ * match.T_reference_current * T_lidar_vehicle);
  estimate.iterations = 1;
  estimate.inliers = match.inliers;
  estimate.rmse = match.rmse;
  estimate.reason = doubts(match);
  estimate.status = estimate.reason.empty() ? MotionStatus::converged : MotionStatus::not_found;
  const Matrix6 adjoint = adjointSE3(T_lidar_vehicle);
  const double precision =
      measurementPrecision(match.rmse, match.effective_points, options_.points_per_measurement);
  estimate.information = precision * adjoint.transpose() * match.normal_matrix * adjoint;
  estimate.information = 0.5 * (estimate.information + estimate.information.transpose()).eval();
  if (options_.confidence && estimate.registered())
  {
    confidence_ = matcher_.staticConfidence();
    for (std::size_t i = 0; i < weights_.size(); ++i)
    {
      confidence_[i] = std::min(confidence_[i], weights_[i]);
    }
  }
  return estimate;
}

void DyloScanMatcher::accept(const Pose& T_reference_current)
{
  std::optional<Pose> T_sweep;
  if (referenceIsPrevious())
  {
    T_sweep = T_vehicle_lidar_.inverse() * T_reference_current * T_vehicle_lidar_;
  }
  matcher_.keepAsReference(T_sweep);
}

std::unique_ptr<ScanMatcher> makeDyloMatcher(const DyloOptions& options)
{
  return std::make_unique<DyloScanMatcher>(options);
}
}  // namespace dyslam
