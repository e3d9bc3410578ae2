// SPDX-License-Identifier: BSD-3-Clause
#include "PageTrajectories.h"

#include <dyslam/eval/TrajectoryReports.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "PageValues.h"
#include "PoseDrift.h"

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;

constexpr double tolerance = 1e-3;  // of stamps; all trajectories have those of the scans [s]
constexpr double milliradian_tenth = 1e-4;
constexpr double speed_reach = 0.25;  // of a speed, before and after its scan [s]

/** x, y, z [m], yaw, pitch, roll [rad] of T * pose, an array of each. */
Json posesJson(const Trajectory& trajectory, const Pose& T)
{
  Json json{{"x", Json::array()},   {"y", Json::array()},     {"z", Json::array()},
            {"yaw", Json::array()}, {"pitch", Json::array()}, {"roll", Json::array()}};
  for (const auto& [stamp, pose] : trajectory)
  {
    const Pose moved = T * pose;
    const Eigen::Vector3d t = moved.translation();
    const Eigen::Vector3d angles = yawPitchRoll(moved);
    json["x"].push_back(rounded(t.x(), millimetre));
    json["y"].push_back(rounded(t.y(), millimetre));
    json["z"].push_back(rounded(t.z(), millimetre));
    json["yaw"].push_back(rounded(angles.x(), milliradian_tenth));
    json["pitch"].push_back(rounded(angles.y(), milliradian_tenth));
    json["roll"].push_back(rounded(angles.z(), milliradian_tenth));
  }
  return json;
}

/** The poses of every n-th scan, moved by T, and the distance travelled up to each, which all scans
 * count for. */
Json pathJson(const Trajectory& trajectory, std::size_t step, const Pose& T = Pose::Identity())
{
  Json json = posesJson(everyNth(trajectory, step), T);
  json["distance"] = rounded(everyNth(trajectory.pathLengths(), step), 0.01);
  return json;
}

/** Takes the odometry to the map frame, for drawing. */
Pose mapFromOdometry(const RunPage& page)
{
  return page.trajectory.empty() ? Pose::Identity()
                                 : page.trajectory[0].pose * page.odometry[0].pose.inverse();
}

Json driftJson(const PosePairs& pairs, std::size_t max_scans)
{
  const PoseDrift drift = poseDrift(pairs);
  std::vector<double> heading_deg;
  for (const double angle : drift.heading)
  {
    heading_deg.push_back(angle * 180 / M_PI);
  }
  const std::size_t step = stepFor(drift.distance.size(), max_scans);
  return {{"distance", rounded(everyNth(drift.distance, step), 0.01)},
          {"position", rounded(everyNth(drift.position, step), 1e-4)},
          {"height", rounded(everyNth(drift.height, step), 1e-4)},
          {"heading", rounded(everyNth(heading_deg, step), 1e-4)}};
}
}  // namespace

void addTrajectories(const RunPage& page, std::size_t step, std::size_t max_scans, Json& json)
{
  json["final"] = pathJson(page.trajectory, step);
  json["odometry"] = pathJson(page.odometry, step, mapFromOdometry(page));
  json["reference"] = page.reference.empty()
                          ? Json()
                          : pathJson(page.reference, stepFor(page.reference.size(), max_scans));
}

void addErrors(const RunPage& page, std::size_t max_scans, Json& json)
{
  json["errors"] = Json::array();
  json["drift"] = Json::object();
  const bool has_truth = page.reference.size() > 1;
  json["drift_against"] = has_truth ? "truth" : "final";
  const Trajectory& against = has_truth ? page.reference : page.trajectory;
  std::vector<std::pair<const char*, const Trajectory*>> estimates{{"odometry", &page.odometry}};
  if (has_truth)
  {
    estimates.insert(estimates.begin(), {"final", &page.trajectory});
  }
  std::vector<TrajectoryReport> reports;
  for (const auto& [name, trajectory] : estimates)
  {
    const PosePairs pairs = associateByTime(against, *trajectory, tolerance);
    if (pairs.size() < 2)
    {
      continue;
    }
    json["drift"][name] = driftJson(pairs, max_scans);
    if (has_truth)
    {
      reports.push_back(evaluateTrajectory(name, pairs));
    }
  }
  if (!reports.empty())
  {
    json["errors"] = Json::parse(trajectoryJson(reports)).at("trajectories");
  }
}

double largestCorrection(const RunPage& page)
{
  const Pose T_map_odom = mapFromOdometry(page);
  double largest = 0;
  for (std::size_t i = 0; i < page.trajectory.size(); ++i)
  {
    const Eigen::Vector3d odometry = T_map_odom * page.odometry[i].pose.translation();
    const double distance = (page.trajectory[i].pose.translation() - odometry).norm();
    largest = distance > largest ? distance : largest;  // NaN is not
  }
  return largest;
}

std::vector<double> speeds(const Trajectory& trajectory)
{
  std::vector<double> result;
  const auto near = [&](std::size_t i, std::size_t j)
  { return std::abs(trajectory[i].stamp - trajectory[j].stamp) <= speed_reach + tolerance; };
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    std::size_t a = i > 0 ? i - 1 : i;
    std::size_t b = std::min(i + 1, trajectory.size() - 1);
    while (a > 0 && near(i, a - 1))
    {
      --a;
    }
    while (b + 1 < trajectory.size() && near(i, b + 1))
    {
      ++b;
    }
    const double seconds = trajectory[b].stamp - trajectory[a].stamp;
    const double distance =
        (trajectory[b].pose.translation() - trajectory[a].pose.translation()).norm();
    result.push_back(seconds > 0 ? distance / seconds : std::nan(""));
  }
  return result;
}
}  // namespace dyslam
