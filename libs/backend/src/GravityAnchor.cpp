// SPDX-License-Identifier: BSD-3-Clause
#include "GravityAnchor.h"

#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace dyslam
{
namespace
{
/** Largest plausible error of the measured magnitude of gravity [m/s^2]. */
constexpr double magnitude_tolerance = 0.5;
constexpr double longest_gap = 0.5;     // longest time between two frames of a window [s]
constexpr double farthest_behind = 10;  // of a sample behind the frame that it came with [s]
constexpr double farthest_ahead = 1;    // of a sample ahead of that frame [s]
constexpr std::size_t least_frames = 8;
constexpr std::size_t least_directions = 3;

Pose poseOf(const FactorGraph& graph, const FrameInKeyframe& frame)
{
  return graph.pose(Key::ego(frame.keyframe)) * frame.T_keyframe_frame;
}

/** The weights of a window: 1 - cos, with their integral normalised to 1. */
struct WindowWeights
{
  double begin;
  double duration;

  /** Weight at a time [1/s]. */
  [[nodiscard]] double at(double time) const { return (1 - std::cos(phase(time))) / duration; }
  /** Integral of the weights up to a time. */
  [[nodiscard]] double until(double time) const
  {
    return (phase(time) - std::sin(phase(time))) / (2 * M_PI);
  }

 private:
  [[nodiscard]] double phase(double time) const { return 2 * M_PI * (time - begin) / duration; }
};
}  // namespace

void GravityOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "use", use,
      {{"off", GravityUse::off}, {"measure", GravityUse::measure}, {"fuse", GravityUse::fuse}},
      "accelerations of an IMU: off; measure: find the vertical; fuse: and optimise the graph with "
      "the measured directions");
  visitor.flag("level_map", level_map,
               "rotate the map at the end of the run so that its z axis is vertical");
  visitor.real("window", window, 0.5, 60,
               "duration over which accelerations are averaged to one direction [s]");
  visitor.degrees("sigma_deg", sigma, 0.001, 90,
                  "standard deviation of a measured direction, per axis [deg]");
  visitor.real("bias_sigma", bias_sigma, 1e-6, 10,
               "standard deviation of the accelerometer's constant error, per axis [m/s^2]");
}

void GravityAnchor::add(double time,
                        const std::vector<ImuSample>& samples,
                        const Pose& T_previous_vehicle)
{
  Interval interval;
  interval.end = time;
  interval.rotation = logSE3(T_previous_vehicle).tail<3>();
  intervals_.push_back(interval);
  if (options_.use == GravityUse::off)
  {
    return;
  }
  waiting_.insert(waiting_.end(), samples.begin(), samples.end());
  std::vector<ImuSample> later;
  for (const ImuSample& sample : waiting_)
  {
    const bool is_near =  // false for a stamp that is not finite
        sample.stamp >= time - farthest_behind && sample.stamp <= time + farthest_ahead;
    if (!is_near || !sample.acceleration || !sample.acceleration->allFinite())
    {
      continue;
    }
    if (sample.stamp > time)
    {
      later.push_back(sample);
    }
    else
    {
      addToInterval(sample);
    }
  }
  waiting_ = std::move(later);
}

void GravityAnchor::addToInterval(const ImuSample& sample)
{
  std::size_t i = intervals_.size() - 1;
  while (i > 0 && intervals_[i - 1].end >= sample.stamp)
  {
    --i;
  }
  if (i == 0)
  {
    return;  // before the first frame
  }
  Interval& interval = intervals_[i];
  const double to_frame =  // 1: at the frame before
      (interval.end - sample.stamp) / (interval.end - intervals_[i - 1].end);
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() = -to_frame * interval.rotation;
  interval.sum += expSE3(turn).linear() * sample.T_vehicle_imu.linear() * *sample.acceleration;
  interval.imu = sample.T_vehicle_imu.translation();
  ++interval.samples;
}

double GravityAnchor::unit() const
{
  constexpr double tolerance = 0.1;  // of a mean magnitude of 1
  double sum = 0;
  std::size_t count = 0;
  for (const Interval& interval : intervals_)
  {
    if (interval.samples > 0)
    {
      sum += interval.mean().norm();
      ++count;
    }
  }
  const bool is_in_g = std::abs(sum - static_cast<double>(count)) < tolerance * sum;
  return is_in_g ? standard_gravity : 1;
}

std::optional<GravityAnchor::Measured> GravityAnchor::measure(
    const FactorGraph& graph,
    const std::vector<FrameInKeyframe>& frames,
    std::size_t first,
    std::size_t last,
    double unit) const
{
  for (std::size_t i = first + 1; i <= last; ++i)
  {
    const double gap = frames[i].time - frames[i - 1].time;
    if (intervals_[i].samples == 0 || gap <= 0 || gap > longest_gap)
    {
      return std::nullopt;
    }
  }
  const WindowWeights weights{frames[first].time, frames[last].time - frames[first].time};
  Measured measured;
  measured.frame = (first + last) / 2;
  const Pose T_middle_map = poseOf(graph, frames[measured.frame]).inverse();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  for (std::size_t i = first; i <= last; ++i)
  {
    const Pose T_middle_frame = T_middle_map * poseOf(graph, frames[i]);
    const Eigen::Vector3d next = T_middle_frame * intervals_[std::max(i, first + 1)].imu;
    if (i > first)
    {
      const double before = frames[i - 1].time;
      const Eigen::Vector3d next_velocity = (next - position) / (frames[i].time - before);
      if (i > first + 1)
      {
        measured.upwards -= weights.at(before) * (next_velocity - velocity);
      }
      velocity = next_velocity;
      measured.upwards += unit * (weights.until(frames[i].time) - weights.until(before)) *
                          (T_middle_frame.linear() * intervals_[i].mean());
    }
    position = next;
  }
  return measured;
}

/** Windows overlap by half. Those that a gap or the end of the run cuts short are left out: the
 * noise of the trajectory's acceleration grows as they shrink. */
std::vector<GravityAnchor::Measured> GravityAnchor::measureAll(
    const FactorGraph& graph, const std::vector<FrameInKeyframe>& frames) const
{
  std::vector<Measured> all;
  const double unit_of_all = unit();
  std::size_t first = 0;
  while (first < frames.size())
  {
    std::size_t last = first;
    std::size_t next = first + 1;
    for (; last + 1 < frames.size() &&
           frames[last + 1].time - frames[first].time <= options_.window + 1e-6;
         ++last)
    {
      if (frames[last + 1].time - frames[first].time <= options_.window / 2)
      {
        next = last + 1;
      }
    }
    const double duration = frames[last].time - frames[first].time;
    if (duration >= options_.window - longest_gap && last - first + 1 >= least_frames)
    {
      if (const auto measured = measure(graph, frames, first, last, unit_of_all))
      {
        all.push_back(*measured);
      }
    }
    first = std::max(first + 1, next);
  }
  return all;
}

std::string GravityAnchor::reasonForFew(std::size_t directions) const
{
  if (options_.use == GravityUse::off)
  {
    return "gravity.use is off";
  }
  if (std::none_of(intervals_.begin(), intervals_.end(),
                   [](const Interval& interval) { return interval.samples > 0; }))
  {
    return "the recording has no accelerations of an IMU";
  }
  return formatted(
      "%zu of %zu directions of gravity that are needed; each takes gravity.window (%g s) "
      "without a gap, and %zu scans",
      directions, least_directions, options_.window, least_frames);
}

GravityAnchor::Solution GravityAnchor::solve(const FactorGraph& graph,
                                             const std::vector<FrameInKeyframe>& frames,
                                             const std::vector<Measured>& all) const
{
  using Matrix36 = Eigen::Matrix<double, 3, 6>;
  const double sigma = options_.sigma * standard_gravity;
  Matrix6 information = Matrix6::Zero();
  information.diagonal().tail<3>().setConstant(1 / (options_.bias_sigma * options_.bias_sigma));
  Vector6 weighted = Vector6::Zero();
  for (const Measured& measured : all)
  {
    Matrix36 rows;
    rows << poseOf(graph, frames[measured.frame]).linear().transpose(), Eigen::Matrix3d::Identity();
    information += rows.transpose() * rows / (sigma * sigma);
    weighted += rows.transpose() * measured.upwards / (sigma * sigma);
  }
  const Vector6 solution = information.ldlt().solve(weighted);
  const Eigen::Matrix2d covariance = information.inverse().topLeftCorner<2, 2>();
  const double variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>()
                              .computeDirect(covariance, Eigen::EigenvaluesOnly)
                              .eigenvalues()[1];
  return {solution.head<3>(), solution.tail<3>(), std::sqrt(variance) / standard_gravity};
}

bool GravityAnchor::addTo(FactorGraph& graph, const std::vector<FrameInKeyframe>& frames)
{
  const std::vector<Measured> all = measureAll(graph, frames);
  if (all.size() < least_directions)
  {
    if (options_.level_map)
    {
      warn("the map is not levelled: " + reasonForFew(all.size()));
    }
    return false;
  }
  const Solution solution = solve(graph, frames, all);
  if (!(std::abs(solution.upwards.norm() - standard_gravity) < magnitude_tolerance))
  {
    warn(
        formatted("the accelerations of the IMU are not used: gravity would be %.2f m/s^2; are "
                  "they in m/s^2, with gravity, and is the pose of the IMU on the vehicle right?",
                  solution.upwards.norm()));
    return false;
  }
  tilt_sigma_ = solution.tilt_sigma;
  Vector6 bias = Vector6::Zero();
  bias.head<3>() = solution.bias;
  graph.addPose(Key::vertical(), levellingOf(solution.upwards));
  graph.addVector(Key::accelerometerBias(), bias);
  Matrix6 weight = Matrix6::Identity();
  weight.diagonal().head<2>().setConstant(1 / (options_.sigma * options_.sigma));
  weight.diagonal().segment<3>(2).setConstant(
      1 / (options_.bias_sigma * options_.bias_sigma * static_cast<double>(all.size())));
  for (const Measured& measured : all)
  {
    const FrameInKeyframe& frame = frames[measured.frame];
    graph.add(std::make_unique<GravityFactor>(
        frame.keyframe, frame.T_keyframe_frame.linear() * measured.upwards, weight));
  }
  return true;
}

void GravityAnchor::removeFrom(FactorGraph& graph)
{
  graph.remove(Key::vertical());
  graph.remove(Key::accelerometerBias());
}

void GravityAnchor::removeYaw(FactorGraph& graph)
{
  const Eigen::Matrix3d R_level_map = graph.pose(Key::vertical()).linear();
  graph.setPose(Key::vertical(), levellingOf(R_level_map.transpose() * Eigen::Vector3d::UnitZ()));
}

double GravityAnchor::rmse(const FactorGraph& graph) const
{
  const Eigen::Matrix3d R_level_map = graph.pose(Key::vertical()).linear();
  const Eigen::Vector3d bias = graph.vector(Key::accelerometerBias()).head<3>();
  double sum = 0;
  const auto& factors = graph.factorsOf(Key::vertical());
  for (const FactorGraph::FactorId id : factors)
  {
    const auto& factor = static_cast<const GravityFactor&>(graph.factor(id));
    const Eigen::Vector3d up =
        R_level_map * graph.pose(factor.keys()[0]).linear() * (factor.upwards() - bias);
    sum += up.head<2>().squaredNorm() / up.squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(factors.size()));
}

bool GravityAnchor::fits(const FactorGraph& graph) const
{
  constexpr double most_sigmas = 3;
  return rmse(graph) < most_sigmas * std::sqrt(2) * options_.sigma;
}

Gravity GravityAnchor::gravity(const FactorGraph& graph) const
{
  Gravity result;
  result.up_map = graph.pose(Key::vertical()).linear().transpose() * Eigen::Vector3d::UnitZ();
  result.tilt = std::acos(std::clamp(result.up_map.z(), -1.0, 1.0));
  result.tilt_sigma = std::hypot(tilt_sigma_, rmse(graph));  // the latter for the drift
  result.bias = graph.vector(Key::accelerometerBias()).head<3>();
  result.directions = graph.factorsOf(Key::vertical()).size();
  result.rmse = rmse(graph);
  return result;
}

void GravityAnchor::exchangeState(StateArchive& archive)
{
  archive(intervals_, waiting_);
}

Pose levellingOf(const Eigen::Vector3d& up_map)
{
  // As Quaterniond::FromTwoVectors, but without its SVD, which takes long to compile.
  const Eigen::Vector3d up = up_map.normalized();
  const double twice_cosine = std::sqrt(2 * (1 + up.z()));  // of half the angle
  Eigen::Quaterniond turn(0, 1, 0, 0);                      // of a map that is upside down
  if (twice_cosine > 1e-6)
  {
    const double factor = 1 / twice_cosine;
    turn = Eigen::Quaterniond(0.5 * twice_cosine, up.y() * factor, -up.x() * factor, 0);
  }
  Pose T_level_map = Pose::Identity();
  T_level_map.linear() = turn.toRotationMatrix();
  return T_level_map;
}
}  // namespace dyslam
