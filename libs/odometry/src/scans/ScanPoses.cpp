// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Quantile.h>
#include <dyslam/odometry/ScanPoses.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double longest_gap = 0.5;         // longest time between interpolated poses [s]
constexpr double stamp_rounding = 1e-5;     // rounding error of time stamps in files [s]
constexpr double denser_than_scans = 0.75;  // step of a dense trajectory, in sweeps

double medianStep(const Trajectory& trajectory)
{
  std::vector<double> steps;
  for (std::size_t i = 1; i < trajectory.size(); ++i)
  {
    steps.push_back(trajectory[i].stamp - trajectory[i - 1].stamp);
  }
  return steps.empty() ? 0 : upperMedian(steps);
}
}  // namespace

ScanPoses::ScanPoses(Trajectory trajectory, double tolerance)
    : trajectory_(std::move(trajectory)), tolerance_(tolerance), step_(medianStep(trajectory_))
{
}

std::optional<Pose> ScanPoses::at(double stamp) const
{
  if (const auto pose = interpolated(stamp))
  {
    return pose;
  }
  const auto nearest = trajectory_.nearest(stamp, tolerance_);
  return nearest ? std::optional<Pose>(trajectory_[*nearest].pose) : std::nullopt;
}

/** The pose with exactly this stamp, if there is one. */
std::optional<Pose> ScanPoses::interpolated(double stamp) const
{
  if (const auto same = trajectory_.nearest(stamp, std::min(stamp_rounding, tolerance_)))
  {
    return trajectory_[*same].pose;
  }
  const std::size_t next = trajectory_.firstNotBefore(stamp);
  if (next == 0 || next == trajectory_.size())
  {
    return std::nullopt;
  }
  const StampedPose& before = trajectory_[next - 1];
  const StampedPose& after = trajectory_[next];
  const double gap = after.stamp - before.stamp;
  // Where a clock was set back, the poses are not in order.
  if (gap > longest_gap || before.stamp > stamp || after.stamp < stamp)
  {
    return std::nullopt;
  }
  return interpolate(before.pose, after.pose, (stamp - before.stamp) / gap);
}

TimedMotion ScanPoses::motionDuring(double stamp, const std::pair<double, double>& span) const
{
  const auto [begin, end] = span;
  const bool is_of_scan = step_ >= denser_than_scans * (end - begin) &&
                          trajectory_.nearest(stamp, stamp_rounding).has_value();
  const auto motion = is_of_scan ? std::nullopt : between(stamp + begin, stamp + end);
  return motion ? *motion : nearestStep(stamp);
}

/** Motion over a time span; at the ends of the trajectory, over the nearest span of this length. */
std::optional<TimedMotion> ScanPoses::between(double begin, double end) const
{
  if (trajectory_.empty() || !(end > begin))
  {
    return std::nullopt;
  }
  const double first = trajectory_[0].stamp;
  const double last = trajectory_[trajectory_.size() - 1].stamp;
  const double shift = begin < first ? first - begin : end > last ? last - end : 0;
  const auto from = interpolated(begin + shift);
  const auto to = interpolated(end + shift);
  if (!from || !to)
  {
    return std::nullopt;
  }
  return TimedMotion{*from, *to, end - begin};
}

TimedMotion ScanPoses::nearestStep(double stamp) const
{
  const auto nearest = trajectory_.nearest(stamp, std::numeric_limits<double>::infinity());
  if (!nearest || trajectory_.size() < 2)
  {
    return {};
  }
  const std::size_t current = std::max<std::size_t>(*nearest, 1);
  const StampedPose& from = trajectory_[current - 1];
  const StampedPose& to = trajectory_[current];
  return {from.pose, to.pose, to.stamp - from.stamp};
}
}  // namespace dyslam
