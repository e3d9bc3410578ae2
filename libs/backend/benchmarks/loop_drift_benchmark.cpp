// SPDX-License-Identifier: BSD-3-Clause
// Loop closing under drift: the odometry of a recording is the ground truth with an error added to
// every step. Prints the number of loops of each run, how many of them are false, and the error at
// the end.
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Error.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>

namespace
{
using dyslam::Frame;
using dyslam::Pose;

constexpr double false_loop = 0.5;  // position error above which a loop is false [m]

struct Drift
{
  double turn = 0;     //!< added heading per metre [rad]
  double stretch = 0;  //!< relative error of every step's length; 0.01: one per cent too long
};

void preparePoints(Frame& frame)
{
  for (const Eigen::Vector3f& p : frame.scan.points)
  {
    const float range = p.norm();
    if (dyslam::isReturn(p) && range > 2.5F && range < 80)
    {
      frame.cloud.points.emplace_back(frame.scan.T_vehicle_lidar.cast<float>() * p);
    }
  }
}

void report(const dyslam::Backend& backend,
            const std::vector<Pose>& truth,
            bool appearance,
            double cpu_ms)
{
  int tried = 0;
  int accepted = 0;
  int by_appearance = 0;
  int wrong = 0;
  int ambiguous = 0;
  for (const dyslam::Loop& loop : backend.loops())
  {
    tried += loop.by_appearance ? 1 : 0;
    ambiguous += loop.verdict == dyslam::LoopVerdict::ambiguous ? 1 : 0;
    if (loop.verdict == dyslam::LoopVerdict::accepted)
    {
      const Pose from = truth[backend.keyframes()[loop.from].frame];
      const Pose to = truth[backend.keyframes()[loop.to].frame];
      const Pose error = loop.T_from_to.inverse() * from.inverse() * to;
      ++accepted;
      by_appearance += loop.by_appearance ? 1 : 0;
      wrong += error.translation().norm() > false_loop ? 1 : 0;
    }
  }
  const Pose estimated = backend.optimisedTrajectory()[truth.size() - 1].pose;
  const Pose off = (truth.front().inverse() * truth.back()).inverse() *
                   backend.optimisedTrajectory()[0].pose.inverse() * estimated;
  std::printf(
      "appearance %-3s  loops %3d (by appearance %3d, false %d), beyond the radius tried %3d, "
      "ambiguous %3d, error at the end %.2f m, %.1f ms a keyframe\n",
      appearance ? "on" : "off", accepted, by_appearance, wrong, tried, ambiguous,
      off.translation().norm(), cpu_ms / static_cast<double>(backend.keyframes().size()));
}

void runThrough(const std::string& rawlog,
                const Drift& drift,
                dyslam::LoopCloserOptions loops,
                bool appearance)
{
  loops.appearance = appearance;
  double cpu_ms = 0;
  dyslam::KeyframeStore keyframes;
  dyslam::BackendConfig config;
  config.loops = loops;
  dyslam::Backend backend(config, keyframes);
  dyslam::RawlogSource source(rawlog);
  std::vector<Pose> truth;
  Pose T_odom = Pose::Identity();
  while (auto frame = source.next())
  {
    if (!frame->T_world_vehicle_truth)
    {
      throw dyslam::UserError(rawlog + ": scan " + std::to_string(frame->index) +
                              " has no ground truth");
    }
    Pose step = truth.empty() ? Pose::Identity()
                              : Pose(truth.back().inverse() * *frame->T_world_vehicle_truth);
    const double length = step.translation().norm();
    step.translation() *= 1 + drift.stretch;
    T_odom = T_odom * step * dyslam::poseFromYpr(0, 0, 0, drift.turn * length, 0, 0);
    truth.push_back(*frame->T_world_vehicle_truth);
    frame->index = truth.size() - 1;
    preparePoints(*frame);
    frame->T_odom_vehicle = T_odom;
    frame->motion.T_previous_current = step;
    frame->motion.status = dyslam::MotionStatus::converged;
    frame->motion.information =
        dyslam::informationFromSigmas(std::max(1e-3, std::abs(drift.stretch) * length),
                                      std::max(1e-4, std::abs(drift.turn) * length));
    const std::clock_t start = std::clock();
    backend.addFrame(*frame);
    cpu_ms += 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  backend.finish();
  report(backend, truth, appearance, cpu_ms);
}
}  // namespace

int main(int argc, char** argv)
{
  if (argc != 4 && argc != 5)
  {
    std::cerr << "usage: loop_drift_benchmark RAWLOG TURN_DEG_PER_100M STRETCH_PERCENT "
                 "[APPEARANCE_DESCRIPTOR_DISTANCE]\n";
    return 1;
  }
  try
  {
    Drift drift;
    drift.turn = std::atof(argv[2]) * M_PI / 180 / 100;
    drift.stretch = std::atof(argv[3]) / 100;
    dyslam::LoopCloserOptions loops;
    if (argc == 5)
    {
      loops.by_appearance.max_descriptor_distance = std::atof(argv[4]);
      loops.nearby.max_descriptor_distance = loops.by_appearance.max_descriptor_distance;
    }
    runThrough(argv[1], drift, loops, false);
    runThrough(argv[1], drift, loops, true);
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
