// SPDX-License-Identifier: BSD-3-Clause
#include "ScanToMap.h"

#include <dyslam/core/Deskew.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr std::size_t row_chunk = 512;
/** Least planarity of a surface: the normal of blobs and lines is undetermined. */
constexpr float min_planarity = 0.2F;
/** Normals nearer to the map's z axis than this cosine belong to the ground. */
constexpr float ground_cosine = 0.9F;
/** Least share of its own weight that the ground keeps: an open field has only ground. */
constexpr double min_ground_weight = 0.2;
/** Residual of outliers, in widths of the robust loss. */
constexpr float kernel_gate = 4;
/** Motion of a point, in cells, after which its surface is looked up again. */
constexpr float lookup_share = 0.2F;
/** Added to the covariance of two distributions, which are otherwise flat [m^2]: 2 cm. */
constexpr float distribution_variance = 4e-4F;
/** Factor on the weight of two distributions, so that the sums of both methods are comparable:
 * where their covariance along the normal is this, the error is the squared distance to a plane
 * [m^2]. */
constexpr double distribution_weight = 8e-4;
/** Steps below which the registration is settled, and below which it counts as converged after the
 * last iteration: translation [m] and rotation [rad]. */
constexpr double settled_step = 3e-4;
constexpr double settled_step_angle = 3e-5;
constexpr double converged_step = 1e-2;
constexpr double converged_step_angle = 1e-3;
/** Sigma of a range measurement [m]: lower limit of the residuals' spread. */
constexpr double sensor_sigma = 0.015;
constexpr double loss_width_decay = 0.6;
/** The prior's robust weight decreases where the points contradict it by more than this many
 * sigmas. */
constexpr double translation_gate = 10;
constexpr double rotation_gate = 3.5;

Vector6 priorWeight(const Matrix6& information, const Vector6& off)
{
  const auto weight = [](const Eigen::Matrix3d& block, const Eigen::Vector3d& e, double most)
  { return 1 / (1 + e.dot(block * e) / (most * most)); };
  Vector6 w;
  w.head<3>().setConstant(
      weight(information.topLeftCorner<3, 3>(), off.head<3>(), translation_gate));
  w.tail<3>().setConstant(
      weight(information.bottomRightCorner<3, 3>(), off.tail<3>(), rotation_gate));
  return w;
}
}  // namespace

NormalEquations ScanToMap::Sums::balanced(double max_ground_weight_ratio) const
{
  NormalEquations all = others;
  const double within = max_ground_weight_ratio * others.weight / std::max(ground.weight, 1e-9);
  all.add(ground, std::clamp(within, min_ground_weight, 1.0));
  return all;
}

void ScanToMap::Sums::add(const Sums& other)
{
  others.add(other.others);
  ground.add(other.ground);
  error += other.error;
  weight += other.weight;
  matched_weight += other.matched_weight;
  inlier_weight += other.inlier_weight;
  inliers += other.inliers;
}

void ScanToMap::refresh(Match& match,
                        const Eigen::Vector3f& q,
                        const Eigen::Vector3f& lidar,
                        const SurfacePyramid& map,
                        const Iteration& iteration) const
{
  match.looked_up_at = q;
  match.surface = map.surfaceAt(q, iteration.base, min_planarity);
  match.offset = match.surface.normal.dot(match.surface.mean);
  match.weight = match.surface.planarity * match.surface.planarity;
  const Eigen::Vector3f ray = q - lidar;
  if (std::abs(match.surface.normal.dot(ray)) < iteration.min_incidence * ray.norm())
  {
    match.weight = 0;
  }
}

/** Adds the distance of a point to the plane of its surface. \param p point, vehicle \param r
 * distance [m] */
void ScanToMap::addPlaneRow(const Match& match,
                            const Eigen::Vector3f& p,
                            float r,
                            const Eigen::Matrix3f& R,
                            double weight,
                            NormalEquations& equations)
{
  const Eigen::Vector3f n = R.transpose() * match.surface.normal;
  Vector6 J;
  J.head<3>() = n.cast<double>();
  J.tail<3>() = p.cross(n).cast<double>();
  equations.addRow(J, static_cast<double>(r), weight * static_cast<double>(match.weight));
}

/** Adds the distance of two distributions, as in generalised ICP. \param p, q point, vehicle and
 * map \param shape covariance around it, vehicle [m^2] */
void ScanToMap::addDistributions(const Match& match,
                                 const Eigen::Vector3f& p,
                                 const Eigen::Vector3f& q,
                                 const Eigen::Matrix3f& shape,
                                 const Eigen::Matrix3f& R,
                                 double weight,
                                 NormalEquations& equations)
{
  const Eigen::Matrix3f C = R.transpose() * match.surface.covariance * R + shape +
                            Eigen::Matrix3f::Identity() * distribution_variance;
  const Eigen::Matrix3d M = C.inverse().cast<double>();
  const Eigen::Vector3d e = (R.transpose() * (q - match.surface.mean)).cast<double>();
  Eigen::Matrix<double, 3, 6> J;
  J.leftCols<3>().setIdentity();
  J.rightCols<3>() = -skew(p.cast<double>());
  // In units of a plane's residual, so that the sums of both methods are comparable.
  const double w = weight * distribution_weight;
  const Eigen::Matrix<double, 6, 3> JtM = w * J.transpose() * M;
  equations.H.noalias() += JtM * J;
  equations.g.noalias() += JtM * e;
  equations.weight += w;
}

void ScanToMap::accumulate(const RawPoints& scan,
                           const std::vector<Eigen::Matrix3f>& shapes,
                           const SurfacePyramid& map,
                           const Iteration& iteration,
                           Sums& total)
{
  const SweepMotion motion(iteration.T_motion, 0);
  const Eigen::Matrix3f& R = iteration.R;
  const float k2 = iteration.loss_width * iteration.loss_width;
  const float lookup_distance = lookup_share * map.cellSize();
  const bool skewed = !scan.phase.empty();
  const bool weighted = !scan.weight.empty();
  parts_.resize(ThreadPool::chunkCount(scan.size(), row_chunk));
  const auto body = [&](std::size_t begin, std::size_t end, std::size_t chunk)
  {
    Sums sums;
    for (std::size_t i = begin; i < end; ++i)
    {
      const Eigen::Vector3f p =
          skewed ? motion.toReference(scan.points[i], scan.phase[i]) : scan.points[i];
      const Eigen::Vector3f q = R * p + iteration.t;
      Match& match = matches_[i];
      if (!((q - match.looked_up_at).lpNorm<Eigen::Infinity>() <= lookup_distance))
      {
        const std::size_t lidar = scan.lidar.empty() ? 0 : scan.lidar[i];
        refresh(match, q, iteration.lidars[lidar], map, iteration);
      }
      const float own_weight = weighted ? scan.weight[i] : 1.0F;
      sums.weight += static_cast<double>(own_weight);
      if (match.weight <= 0)
      {
        continue;
      }
      sums.matched_weight += static_cast<double>(own_weight);
      const float r = match.surface.normal.dot(q) - match.offset;
      const float r2 = r * r;
      if (!(r2 <= kernel_gate * kernel_gate * k2))
      {
        continue;
      }
      // Geman-McClure
      const float robust = k2 / (k2 + r2);
      const float base_weight = own_weight * robust * robust;
      const bool is_ground = std::abs(match.surface.normal.z()) > ground_cosine;
      NormalEquations& equations = is_ground ? sums.ground : sums.others;
      const auto w = static_cast<double>(base_weight);
      if (iteration.distributions)
      {
        addDistributions(match, p, q, shapes[i], R, w, equations);
      }
      else
      {
        addPlaneRow(match, p, r, R, w, equations);
      }
      sums.error += static_cast<double>(base_weight * r2);
      sums.inlier_weight += static_cast<double>(base_weight);
      ++sums.inliers;
    }
    parts_[chunk] = sums;
  };
  pool_.forChunks(scan.size(), row_chunk, body);
  for (const Sums& part : parts_)
  {
    total.add(part);
  }
}

void ScanToMap::Iteration::setPose(const Pose& T,
                                   const Pose& T_before,
                                   const std::vector<Eigen::Vector3f>& lidars_of_vehicle)
{
  T_motion = T_before.inverse() * T;
  R = T.linear().cast<float>();
  t = (T.translation() - base.origin).cast<float>();
  lidars.clear();
  for (const Eigen::Vector3f& lidar : lidars_of_vehicle)
  {
    lidars.emplace_back(R * lidar + t);
  }
}

Vector6 ScanToMap::solve(const Sums& sums,
                         const ScanToMapSettings& settings,
                         const Pose& T_prior,
                         ScanToMapResult& result)
{
  const NormalEquations equations = sums.balanced(settings.max_ground_weight_ratio);
  const double variance = sums.error / std::max(sums.inlier_weight, 1e-9);
  const double unit =
      (variance + sensor_sigma * sensor_sigma) * std::max(1.0, settings.points_per_measurement);
  result.rmse = std::sqrt(variance);
  result.inliers = sums.inliers;
  result.inlier_share = sums.weight > 0 ? sums.inlier_weight / sums.weight : 0;
  result.surface_share = sums.weight > 0 ? sums.matched_weight / sums.weight : 0;
  result.inlier_ratio = sums.matched_weight > 0 ? sums.inlier_weight / sums.matched_weight : 0;
  result.information = equations.H / unit;

  const Vector6 off_prior = logSE3(T_prior.inverse() * result.T);
  result.prior_weight = priorWeight(settings.prior_information, off_prior);
  const Vector6 root = result.prior_weight.cwiseSqrt();
  const Matrix6 prior = root.asDiagonal() * settings.prior_information * root.asDiagonal();
  const Matrix6 H = result.information + prior;
  const Vector6 g = equations.g / unit + prior * off_prior;
  return -(H + 1e-9 * Matrix6::Identity()).ldlt().solve(g);
}

ScanToMapResult ScanToMap::align(const RawPoints& scan,
                                 const std::vector<Eigen::Matrix3f>& shapes,
                                 const SurfacePyramid& map,
                                 const Pose& T_before,
                                 const Pose& T_guess,
                                 const ScanToMapSettings& settings)
{
  ScanToMapResult result;
  result.T = T_guess;
  const Pose T_prior = settings.T_prior.value_or(T_guess);
  matches_.resize(scan.size());
  for (Match& match : matches_)
  {
    match.looked_up_at.setConstant(1e9F);
  }
  Iteration iteration;
  iteration.base = map.baseAt(T_guess.translation());
  iteration.min_incidence = static_cast<float>(settings.min_incidence);
  iteration.distributions = settings.distributions;
  double loss_width = std::max(settings.loss_width, settings.start_loss_width);
  while (result.iterations < settings.max_iterations)
  {
    iteration.setPose(result.T, T_before, settings.lidars);
    iteration.loss_width = static_cast<float>(loss_width);
    Sums sums;
    accumulate(scan, shapes, map, iteration, sums);
    ++result.iterations;
    const Vector6 step = solve(sums, settings, T_prior, result);
    if (!step.allFinite())
    {
      result.converged = false;
      result.finite = false;
      break;
    }
    result.T = orthonormalised(result.T * expSE3(step));
    if (loss_width <= settings.loss_width && step.head<3>().norm() < settled_step &&
        step.tail<3>().norm() < settled_step_angle)
    {
      result.converged = true;
      break;
    }
    result.converged =
        step.head<3>().norm() < converged_step && step.tail<3>().norm() < converged_step_angle;
    loss_width = std::max(settings.loss_width, loss_width_decay * loss_width);
  }
  return result;
}
}  // namespace dyslam
