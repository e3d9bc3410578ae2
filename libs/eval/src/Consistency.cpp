// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/eval/Consistency.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

namespace dyslam
{
namespace
{
/** Normalised squared errors of several motions. */
struct Values
{
  std::vector<double> all;
  std::vector<double> translation;
  std::vector<double> rotation;

  void add(const Vector6& error, const Matrix6& covariance)
  {
    const Eigen::LLT<Matrix6> cholesky(covariance);
    const double value = error.dot(cholesky.solve(error));
    if (cholesky.info() != Eigen::Success || !std::isfinite(value))
    {
      return;
    }
    const auto part = [&](int at)
    {
      const Eigen::Vector3d e = error.segment<3>(at);
      return e.dot(Eigen::Matrix3d(covariance.block<3, 3>(at, at)).llt().solve(e));
    };
    all.push_back(value);
    translation.push_back(part(0));
    rotation.push_back(part(3));
  }

  [[nodiscard]] NormalisedErrors statistics() const
  {
    return {statisticsOf(all), statisticsOf(translation), statisticsOf(rotation)};
  }
};

/** Index of the pair nearest in time, if it is within the tolerance. */
std::optional<std::size_t> pairAt(const PosePairs& pairs, double stamp, double tolerance)
{
  auto nearest = std::lower_bound(pairs.stamps.begin(), pairs.stamps.end(), stamp);
  if (nearest != pairs.stamps.begin() &&
      (nearest == pairs.stamps.end() || stamp - *std::prev(nearest) <= *nearest - stamp))
  {
    --nearest;
  }
  if (nearest == pairs.stamps.end() || std::abs(*nearest - stamp) > tolerance)
  {
    return std::nullopt;
  }
  return static_cast<std::size_t>(nearest - pairs.stamps.begin());
}

/** log(T_estimated^-1 T_true) of the motion from one pose to another. */
Vector6 errorBetween(const PosePairs& pairs, std::size_t from, std::size_t to)
{
  const Pose estimated = pairs.estimate[from].inverse() * pairs.estimate[to];
  const Pose truth = pairs.reference[from].inverse() * pairs.reference[to];
  return logSE3(estimated.inverse() * truth);
}
}  // namespace

OdometryConsistency odometryConsistency(const PosePairs& odometry,
                                        const std::vector<MotionCovariance>& motions,
                                        double tolerance)
{
  Values steps;
  Values keyframes;
  MotionAccumulator since_keyframe;
  std::optional<std::size_t> previous;
  std::optional<std::size_t> keyframe;
  bool complete = false;  // all motions since the keyframe are known
  for (std::size_t i = 0; i < motions.size(); ++i)
  {
    const auto now = pairAt(odometry, motions[i].stamp, tolerance);
    complete = complete && now.has_value();
    if (i > 0 && previous && now)
    {
      const Pose step = odometry.estimate[*previous].inverse() * odometry.estimate[*now];
      steps.add(errorBetween(odometry, *previous, *now), motions[i].covariance);
      since_keyframe.add(step, motions[i].covariance, motions[i].pose_noise);
    }
    if (motions[i].is_keyframe)
    {
      if (complete && keyframe)
      {
        keyframes.add(errorBetween(odometry, *keyframe, *now), since_keyframe.covariance());
      }
      since_keyframe.restart();
      keyframe = now;
      complete = now.has_value();
    }
    previous = now;
  }
  return {"", steps.statistics(), keyframes.statistics()};
}

Table consistencyTable(const std::vector<OdometryConsistency>& runs)
{
  Table table(
      {"run", "motions", "count", "mean", "median", "translation", "rotation"},
      "Normalised estimation error squared (NEES) of the odometry: mean 6 is consistent (3 for "
      "translation or rotation alone), more is overconfident, less underconfident");
  for (const OdometryConsistency& run : runs)
  {
    const auto add = [&](const char* motions, const NormalisedErrors& errors)
    {
      if (errors.all.count > 0)
      {
        table.addRow({run.name, motions, TableCell(static_cast<double>(errors.all.count), 0),
                      TableCell(errors.all.mean, 2), TableCell(errors.all.median, 2),
                      TableCell(errors.translation.mean, 2), TableCell(errors.rotation.mean, 2)});
      }
    };
    add("scan to scan", run.steps);
    add("keyframe to keyframe", run.keyframes);
  }
  return table;
}
}  // namespace dyslam
