// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace dyslam
{
namespace
{

/** Error of the estimated motion from i to j: inverse(estimated) * true. */
Pose motionError(const PosePairs& pairs, std::size_t i, std::size_t j)
{
  const Pose truth = pairs.reference[i].inverse() * pairs.reference[j];
  const Pose estimated = pairs.estimate[i].inverse() * pairs.estimate[j];
  return estimated.inverse() * truth;
}

/** Direction of the line of the reference's positions, if these are so nearly collinear that the
 * orientations determine the rotation about it better: the spread across is less than a fifth of
 * the spread along, and less than a hundred times the residual error across after alignment with R.
 */
std::optional<Eigen::Vector3d> degenerateLine(const PosePairs& pairs,
                                              const Eigen::Vector3d& reference_mean,
                                              const Eigen::Vector3d& estimate_mean,
                                              const Eigen::Matrix3d& R)
{
  constexpr double max_aspect_ratio = 0.2;
  constexpr double min_signal_to_noise = 100;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d error = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Eigen::Vector3d r = pairs.reference[i].translation() - reference_mean;
    const Eigen::Vector3d d = r - R * (pairs.estimate[i].translation() - estimate_mean);
    spread += r * r.transpose();
    error += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d& squares = solver.eigenvalues();  // in ascending order
  const Eigen::Vector3d direction = solver.eigenvectors().col(2);
  const double error_across = error.trace() - direction.dot(error * direction);
  const bool is_degenerate = squares[1] < max_aspect_ratio * max_aspect_ratio * squares[2] &&
                             squares[1] < min_signal_to_noise * min_signal_to_noise * error_across;
  return is_degenerate ? std::optional<Eigen::Vector3d>(direction) : std::nullopt;
}

/** The rotation Q about `axis` that minimises sum |R_r - Q R R_e|^2.
 * \param orientations sum R_r R_e^T. */
Eigen::Matrix3d optimalRotationAbout(const Eigen::Vector3d& axis,
                                     const Eigen::Matrix3d& orientations,
                                     const Eigen::Matrix3d& R)
{
  const Eigen::Matrix3d a = orientations * R.transpose();
  const Eigen::Vector3d skew(a(2, 1) - a(1, 2), a(0, 2) - a(2, 0), a(1, 0) - a(0, 1));
  const double angle = std::atan2(axis.dot(skew), a.trace() - axis.dot(a * axis));
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

struct OptimalRotation
{
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  bool turned_by_orientations = false;  //!< about the line of collinear positions
};

/** The rotation R that minimises sum |r_i - R e_i|^2 for centred positions (Kabsch, Umeyama); about
 * a line of collinear positions, that of the orientations. */
OptimalRotation optimalRotation(const PosePairs& pairs,
                                const Eigen::Vector3d& reference_mean,
                                const Eigen::Vector3d& estimate_mean)
{
  Eigen::Matrix3d positions = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d orientations = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Eigen::Vector3d r = pairs.reference[i].translation() - reference_mean;
    const Eigen::Vector3d e = pairs.estimate[i].translation() - estimate_mean;
    positions += r * e.transpose();
    orientations += pairs.reference[i].linear() * pairs.estimate[i].linear().transpose();
    spread += r.squaredNorm() + e.squaredNorm();
  }
  if (!pairs.positions_only)
  {
    // Negligible unless the positions do not determine the rotation.
    constexpr double orientation_weight = 1e-9;
    const double scale = spread > 0 ? spread : 1.0;
    positions += orientation_weight * scale / static_cast<double>(pairs.size()) * orientations;
  }

  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(positions, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity();
  mirror(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d R = svd.matrixU() * mirror * svd.matrixV().transpose();
  const auto line =
      pairs.positions_only ? std::nullopt : degenerateLine(pairs, reference_mean, estimate_mean, R);
  return line ? OptimalRotation{optimalRotationAbout(*line, orientations, R) * R, true}
              : OptimalRotation{R, false};
}

/** T_reference_estimate, and whether the orientations turned it about the line of the path. */
std::pair<Pose, bool> aligned(const PosePairs& pairs, Alignment alignment)
{
  if (pairs.size() == 0 || alignment == Alignment::none)
  {
    return {Pose::Identity(), false};
  }
  if (alignment == Alignment::first)
  {
    return {pairs.reference.front() * pairs.estimate.front().inverse(), false};
  }
  Eigen::Vector3d reference_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_mean = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    reference_mean += pairs.reference[i].translation();
    estimate_mean += pairs.estimate[i].translation();
  }
  reference_mean /= static_cast<double>(pairs.size());
  estimate_mean /= static_cast<double>(pairs.size());
  const OptimalRotation rotation = optimalRotation(pairs, reference_mean, estimate_mean);
  Pose T_reference_estimate = Pose::Identity();
  T_reference_estimate.linear() = rotation.R;
  T_reference_estimate.translation() =
      reference_mean - T_reference_estimate.linear() * estimate_mean;
  return {T_reference_estimate, rotation.turned_by_orientations};
}
}  // namespace

std::string toString(Alignment alignment)
{
  switch (alignment)
  {
    case Alignment::none:
      return "none";
    case Alignment::first:
      return "first";
    case Alignment::se3:
      return "se3";
  }
  return "none";
}

std::string describe(Alignment alignment)
{
  switch (alignment)
  {
    case Alignment::none:
      break;
    case Alignment::first:
      return "aligned to the reference at the first pose";
    case Alignment::se3:
      return "aligned to the reference by rotation and translation";
  }
  return "not aligned";
}

Alignment alignmentFromString(const std::string& word)
{
  for (const auto candidate : {Alignment::none, Alignment::first, Alignment::se3})
  {
    if (toString(candidate) == word)
    {
      return candidate;
    }
  }
  throw UserError("alignment '" + word + "' is unknown: use none, first or se3");
}

KittiDrift kittiDrift(const PosePairs& pairs, const std::vector<double>& lengths, std::size_t step)
{
  if (step == 0)
  {
    throw std::invalid_argument("kittiDrift: step must be at least 1");
  }
  KittiDrift result;
  for (const double length : lengths)
  {
    if (!(length > 0) || !std::isfinite(length))
    {
      throw std::invalid_argument("kittiDrift: segment lengths must be positive");
    }
    SegmentDrift drift;
    drift.length = length;
    result.per_length.push_back(drift);
  }
  const std::vector<double> distance = distanceTravelled(pairs.reference);
  for (std::size_t first = 0; first < pairs.size(); first += step)
  {
    for (auto& drift : result.per_length)
    {
      const auto end = std::upper_bound(distance.begin() + static_cast<std::ptrdiff_t>(first),
                                        distance.end(), distance[first] + drift.length);
      if (end == distance.end())
      {
        continue;
      }
      const Pose error =
          motionError(pairs, first, static_cast<std::size_t>(end - distance.begin()));
      ++drift.segments;
      drift.translation_percent += 100 * error.translation().norm() / drift.length;
      drift.rotation_deg_per_100m += 100 * degrees_per_radian * rotationAngle(error) / drift.length;
    }
  }
  const auto divide = [](SegmentDrift& drift)
  {
    if (drift.segments > 0)
    {
      drift.translation_percent /= static_cast<double>(drift.segments);
      drift.rotation_deg_per_100m /= static_cast<double>(drift.segments);
    }
  };
  for (auto& drift : result.per_length)
  {
    result.overall.segments += drift.segments;
    result.overall.translation_percent += drift.translation_percent;
    result.overall.rotation_deg_per_100m += drift.rotation_deg_per_100m;
    divide(drift);
  }
  divide(result.overall);
  return result;
}

RelativePoseError relativePoseError(const PosePairs& pairs)
{
  std::vector<double> translation;
  std::vector<double> rotation;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i)
  {
    const Pose error = motionError(pairs, i, i + 1);
    translation.push_back(error.translation().norm());
    rotation.push_back(degrees_per_radian * rotationAngle(error));
  }
  return {statisticsOf(translation), statisticsOf(rotation)};
}

Pose alignEstimate(const PosePairs& pairs, Alignment alignment)
{
  return aligned(pairs, alignment).first;
}

AbsoluteTrajectoryError absoluteTrajectoryError(const PosePairs& pairs, Alignment alignment)
{
  AbsoluteTrajectoryError result;
  std::tie(result.T_reference_estimate, result.turned_by_orientations) = aligned(pairs, alignment);
  std::vector<double> translation;
  std::vector<double> rotation;
  for (std::size_t i = 0; i < pairs.size(); ++i)
  {
    const Pose estimate = result.T_reference_estimate * pairs.estimate[i];
    translation.push_back((estimate.translation() - pairs.reference[i].translation()).norm());
    if (!pairs.positions_only)
    {
      rotation.push_back(degrees_per_radian *
                         rotationAngle(pairs.reference[i].inverse() * estimate));
    }
  }
  result.translation = statisticsOf(translation);
  result.rotation_deg = statisticsOf(rotation);
  return result;
}

std::optional<double> forwardRatio(const PosePairs& pairs)
{
  constexpr double min_step = 1e-6;
  double true_sum = 0;
  double estimated_sum = 0;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i)
  {
    const Eigen::Vector3d truth =
        (pairs.reference[i].inverse() * pairs.reference[i + 1]).translation();
    const Eigen::Vector3d estimated =
        (pairs.estimate[i].inverse() * pairs.estimate[i + 1]).translation();
    const double length = truth.norm();
    if (length > min_step)
    {
      true_sum += length;
      estimated_sum += estimated.dot(truth) / length;
    }
  }
  if (true_sum <= 0)
  {
    return std::nullopt;
  }
  return estimated_sum / true_sum;
}

EndError endError(const PosePairs& pairs)
{
  EndError result;
  if (pairs.size() < 2)
  {
    return result;
  }
  const Pose error = motionError(pairs, 0, pairs.size() - 1);
  const double length = distanceTravelled(pairs.reference).back();
  result.translation = error.translation().norm();
  result.rotation_deg = degrees_per_radian * rotationAngle(error);
  result.percent = length > 0 ? 100 * result.translation / length : 0;
  return result;
}

TrajectoryReport evaluateTrajectory(const std::string& name,
                                    const PosePairs& pairs,
                                    const TrajectoryMetricsOptions& options)
{
  if (pairs.size() < 2)
  {
    throw UserError(name + ": only " + std::to_string(pairs.size()) + " of " +
                    std::to_string(pairs.estimate_size) +
                    " poses match the reference's time stamps, 2 are needed: is it the reference "
                    "of this run?");
  }
  if (pairs.positions_only && options.alignment == Alignment::first)
  {
    throw UserError(name +
                    ": the alignment 'first' needs orientations, which the reference does "
                    "not have: use se3 or none");
  }
  TrajectoryReport report;
  report.name = name;
  report.positions_only = pairs.positions_only;
  report.alignment = options.alignment;
  report.reference_size = pairs.reference_size;
  report.estimate_size = pairs.estimate_size;
  report.pairs = pairs.size();
  report.not_finite = pairs.not_finite;
  report.length = distanceTravelled(pairs.reference).back();
  constexpr std::size_t segment_step = 10;  // frames, as in the benchmark's devkit
  report.absolute = absoluteTrajectoryError(pairs, options.alignment);
  const PosePairs none;
  const PosePairs& motions = pairs.positions_only ? none : pairs;
  report.drift = kittiDrift(motions, options.lengths, segment_step);
  report.relative = relativePoseError(motions);
  report.forward_ratio = forwardRatio(motions);
  report.end = endError(motions);
  return report;
}
}  // namespace dyslam
