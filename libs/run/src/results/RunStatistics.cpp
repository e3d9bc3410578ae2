// SPDX-License-Identifier: BSD-3-Clause
#include "RunStatistics.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/base/Words.h>
#include <dyslam/odometry/MotionSensors.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace dyslam
{
namespace
{
constexpr double unusable_share = 0.5;  // share of scans not registered: more is unusable
constexpr double doubtful_share = 0.2;  // share of scans not registered: more is doubtful

/** Advice for the user. \param ini that was given, which may be the reason; empty: none
 * \param sensors assignments that do without the IMU and wheel odometry in use; empty: none is */
std::string adviceFor(FailureCause cause, const std::string& ini, const std::string& sensors)
{
  switch (cause)
  {
    case FailureCause::recording:
      return "check the recording, and how it was converted";
    case FailureCause::preprocessing:
      return "change these settings, or check that the points are in metres, in the frame of the "
             "lidar";
    case FailureCause::estimation:
      break;
  }
  constexpr const char* handheld = "handheld.ini";
  const bool is_handheld = std::filesystem::path(ini).filename() == handheld;
  return "try " + std::string(ini.empty() ? "" : "the settings that fit the sensor (no -c), ") +
         (is_handheld ? "" : std::string("-c ") + handheld + " for a hand-held sensor, ") +
         "or odometry.start_speed for a recording that begins in motion" +
         (sensors.empty() ? ""
                          : "; or without IMU and wheel odometry, whose units, poses or clocks may "
                            "be wrong: " +
                                sensors);
}

View viewOf(const std::vector<Eigen::Vector3f>& points)
{
  constexpr std::size_t stride = 16;
  constexpr double near = 10;  // [m]
  constexpr double min_share_near = 0.05;
  View view;
  double count = 0;
  double count_near = 0;
  double squares = 0;  // sum of the squared distances from the vehicle [m^2]
  for (std::size_t i = 0; i < points.size(); i += stride)
  {
    const Eigen::Vector2d point = points[i].head<2>().cast<double>();
    const double distance = point.norm();
    if (distance > 0)
    {
      view.direction += point / distance;
      view.centre += point;
      squares += distance * distance;
      count += 1;
      count_near += distance < near ? 1 : 0;
    }
  }
  if (count > 0)
  {
    view.direction /= count;
    view.centre /= count;
    view.spread = std::sqrt(std::max(0.0, squares / count - view.centre.squaredNorm()));
    view.has_near = count_near >= min_share_near * count;
  }
  return view;
}
}  // namespace

void Reasons::add(const MotionEstimate& failed)
{
  std::string kind = failed.reason;
  std::replace_if(
      kind.begin(), kind.end(), [](unsigned char c) { return std::isdigit(c) != 0; }, '0');
  Kind& same = kinds_[kind];
  ++same.count;
  same.example = failed.reason;
  same.cause = failed.cause;
  ++total_;
}

Reasons::Kind Reasons::mostFrequent() const
{
  const auto most = std::max_element(kinds_.begin(), kinds_.end(),
                                     [](const auto& a, const auto& b)
                                     { return a.second.count < b.second.count; });
  return most == kinds_.end() ? Kind() : most->second;
}

bool View::differsFrom(const View& other) const
{
  constexpr double other_direction = 0.5;
  constexpr double other_place = 0.5;  // times the spread
  // What passes a lidar hides what is behind it, which moves the centre of the points; without
  // points near the vehicle nothing passes, and the vehicle is far from the origin of a map.
  const bool is_far = !has_near && !other.has_near;
  return (direction - other.direction).norm() > other_direction ||
         (is_far && (centre - other.centre).norm() > other_place * other.spread);
}

void Views::add(const std::vector<Eigen::Vector3f>& cloud)
{
  constexpr std::size_t many_more = 2;  // times the points
  const View view = viewOf(cloud);
  if (cloud.size() > many_more * first_points)
  {
    first = view;
    first_points = cloud.size();
    shifted = 0;
  }
  shifted += !cloud.empty() && view.differsFrom(first) ? 1U : 0U;
}

void RunStatistics::add(const Frame& frame)
{
  first_time = frames == 0 ? frame.time() : first_time;
  last_time = frame.time();
  ++frames;
  views.add(frame.cloud.points);
  farthest = std::max(farthest, frame.T_odom_vehicle.translation().norm());
  largest_turn = std::max(largest_turn, rotationAngle(frame.T_odom_vehicle));
  map_restarts += frame.motion.map_restarted ? 1U : 0U;
  if (frame.motion.registered())
  {
    const Eigen::Vector3d step = frame.motion.T_previous_current.translation();
    path += step.norm();
    path_forward += step.x();
    path_left += step.y();
  }
  else
  {
    registration_failures.add(frame.motion);
    unregistered_keyframes += frame.is_keyframe ? 1U : 0U;
  }
  not_settled += frame.motion.status == MotionStatus::not_settled ? 1U : 0U;
  if (!frame.odometry.registered())
  {
    odometry_failures.add(frame.odometry);
  }
  has_imu = has_imu || !frame.imu.empty();
  has_wheels = has_wheels || !frame.wheels.empty();
  points += frame.cloud.size();
  const std::vector<float>& times = frame.cloud.phase;
  if (!frame.cloud.points.empty())
  {
    const bool differ = std::any_of(times.begin(), times.end(),
                                    [&times](float time) { return time != times.front(); });
    without_times += times.empty() ? 1U : 0U;
    equal_times += !times.empty() && !differ ? 1U : 0U;
  }
  detections += frame.detections.size();
  moving_points +=
      static_cast<std::size_t>(std::count(frame.moving.begin(), frame.moving.end(), true));
  if (frame.T_world_vehicle_truth)
  {
    reference.push_back(frame.scan.stamp, *frame.T_world_vehicle_truth);
  }
}

double RunStatistics::recordingTime() const
{
  const auto n = static_cast<double>(frames);
  return frames > 1 ? (last_time - first_time) * n / (n - 1) : 0;
}

Trajectory RunStatistics::referenceInMap(const Trajectory& trajectory) const
{
  Trajectory result;
  if (reference.empty())
  {
    return result;
  }
  const auto start = trajectory.at(reference[0].stamp);
  const Pose T_map_world = start.value_or(Pose::Identity()) * reference[0].pose.inverse();
  for (const StampedPose& truth : reference)
  {
    result.push_back(truth.stamp, T_map_world * truth.pose);
  }
  return result;
}

std::vector<std::string> RunStatistics::warnings(bool has_labels) const
{
  std::vector<std::string> result;
  for (const std::string& warning :
       {odometryWarning(), registrationWarning(), settlingWarning(), secondPassAdvice(has_labels),
        directionWarning(), frameWarning(), restartWarning(), keyframeWarning(),
        failedOnMoreThan(unusable_share) ? "" : deskewingAdvice()})
  {
    if (!warning.empty())
    {
      result.push_back(warning);
    }
  }
  return result;
}

std::string RunStatistics::odometryWarning() const
{
  if (static_cast<double>(odometry_failures.total()) <=
      doubtful_share * static_cast<double>(frames))
  {
    return "";
  }
  return "odometry.method found no motion on " + std::to_string(odometry_failures.total()) +
         " of " + counted(frames, "scan") +
         ", most often because: " + odometry_failures.mostFrequent().example +
         " (scans.csv has the reason of each)";
}

std::string RunStatistics::registrationWarning() const
{
  return failedOnMoreThan(doubtful_share) && !failedOnMoreThan(unusable_share)
             ? registrationSentence("check trajectory and map")
             : "";
}

std::string RunStatistics::settlingWarning() const
{
  if (static_cast<double>(not_settled) <= doubtful_share * static_cast<double>(frames))
  {
    return "";
  }
  return "the registration of " + std::to_string(not_settled) + " of " + counted(frames, "scan") +
         " ended before it converged: their motions are less accurate; raise "
         "refine.max_iterations";
}

std::string RunStatistics::restartWarning() const
{
  if (map_restarts == 0)
  {
    return "";
  }
  return "the local map was restarted " +
         (map_restarts == 1 ? "once" : std::to_string(map_restarts) + " times") +
         ", as scans in a row could not be registered: check trajectory and map; the "
         "trajectory before and after is joined by prediction only";
}

std::string RunStatistics::keyframeWarning() const
{
  if (unregistered_keyframes == 0)
  {
    return "";
  }
  return "the points of " + counted(unregistered_keyframes, "keyframe") +
         " are not in the map, as " + (unregistered_keyframes == 1 ? "this scan" : "these scans") +
         " could not be registered";
}

std::string RunStatistics::secondPassAdvice(bool has_labels) const
{
  constexpr double dense_traffic = 0.15;  // share of moving points
  if (has_labels || failedOnMoreThan(unusable_share) ||
      static_cast<double>(moving_points) <= dense_traffic * static_cast<double>(points))
  {
    return {};
  }
  return std::to_string(100 * moving_points / points) +
         " % of the points move: in traffic as dense as this the odometry may follow the vehicles; "
         "compare with a second pass (--passes 2)";
}

std::string RunStatistics::directionWarning() const
{
  constexpr double min_path = 10;  // [m]
  constexpr double min_share = 0.9;
  constexpr double min_angle = 30 * radians_per_degree;
  const double angle = std::atan2(path_left, path_forward);
  if (failedOnMoreThan(unusable_share) || path < min_path ||
      std::hypot(path_forward, path_left) < min_share * path || std::abs(angle) < min_angle)
  {
    return {};
  }
  const std::string degrees = std::to_string(std::lround(std::abs(angle) * degrees_per_radian));
  return "the vehicle moved " + degrees + " deg to the " + (angle > 0 ? "left" : "right") +
         " of its x axis, which should point forward: if the lidar is mounted rotated, convert the "
         "recording with a yaw (--sensor-pose) that is " +
         degrees + " deg " + (angle > 0 ? "less" : "more") + ": '0 0 0 " + (angle > 0 ? "-" : "") +
         degrees + " 0 0' if it had none";
}

std::string RunStatistics::frameWarning() const
{
  constexpr double at_rest = 2;  // [m]
  constexpr double not_turned = 30 * radians_per_degree;
  constexpr double min_share = 0.2;
  if (farthest > at_rest || largest_turn > not_turned ||
      static_cast<double>(views.shifted) < min_share * static_cast<double>(frames))
  {
    return {};
  }
  return "the vehicle is at rest, but sees the points elsewhere than at first: they seem to be in "
         "the frame of a map, where nothing moves; the scans must be in the frame of the lidar";
}

std::string RunStatistics::failure(const std::string& ini, const MotionSensorOptions& sensors) const
{
  if (!failedOnMoreThan(unusable_share))
  {
    return {};
  }
  std::string without;
  if (has_imu && sensors.gyroscope)
  {
    appendWord(without, "motion_sensors.gyroscope=false", ", ");
  }
  if (has_wheels && sensors.wheel_odometry)
  {
    appendWord(without, "motion_sensors.wheel_odometry=false", ", ");
  }
  const std::string deskewing = deskewingAdvice();
  return registrationSentence("do not trust trajectory and map") + "; " +
         (deskewing.empty() ? "" : deskewing + "; otherwise ") +
         adviceFor(registration_failures.mostFrequent().cause, ini, without);
}

std::string RunStatistics::deskewingAdvice() const
{
  constexpr double most = 0.5;
  const double needed = most * static_cast<double>(frames);
  const bool has_failures = failedOnMoreThan(doubtful_share) || map_restarts > 0;
  const bool has_none = static_cast<double>(without_times) > needed;
  if (!has_failures || (!has_none && static_cast<double>(equal_times) <= needed))
  {
    return {};
  }
  return std::string(has_none
                         ? "the scans were not deskewed; if they were recorded in motion"
                         : "all points of a scan have the same time, so that the scans counted "
                           "as deskewed; if they were not") +
         ", that is a likely reason of the failed registrations: use a recording with the times of "
         "the points or, for a lidar that turns clockwise and begins each scan straight behind, "
         "preprocess.deskew=azimuth";
}

std::string RunStatistics::verdict() const
{
  if (failedOnMoreThan(unusable_share))
  {
    return "unusable";
  }
  return failedOnMoreThan(doubtful_share) || map_restarts > 0 || !frameWarning().empty()
             ? "doubtful"
             : "usable";
}

bool RunStatistics::failedOnMoreThan(double share) const
{
  return static_cast<double>(registration_failures.total()) > share * static_cast<double>(frames);
}

std::string RunStatistics::registrationSentence(const std::string& consequence) const
{
  return std::to_string(registration_failures.total()) + " of " + counted(frames, "scan") +
         " could not be registered: " + consequence +
         "; most often because: " + registration_failures.mostFrequent().example;
}

void Reasons::exchangeState(StateArchive& archive)
{
  archive(kinds_, total_);
}

void RunStatistics::exchangeState(StateArchive& archive)
{
  archive(frames, first_time, last_time, registration_failures, map_restarts,
          unregistered_keyframes, not_settled, odometry_failures, has_imu, has_wheels, path,
          path_forward, path_left, farthest, largest_turn, views, points, moving_points, detections,
          without_times, equal_times, reference);
}
}  // namespace dyslam
