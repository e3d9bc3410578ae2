// SPDX-License-Identifier: BSD-3-Clause
// Loops of a recording whose odometry is the ground truth with an error added to every step: what
// drift they survive. Prints each run's loops, how many of them are false, and the error at the
// end.
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>

namespace
{
using dyslam::Frame;
using dyslam::Pose;

constexpr double false_loop = 0.5;  // a loop off by more is false [m]

struct Drift
{
  double turn = 0;     //!< added heading per metre [rad]
  double stretch = 0;  //!< of every step, 0.01: one per cent too long
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

void report(const dyslam::Backend& backend, const std::vector<Pose>& truth, bool appearance)
{
  int accepted = 0;
  int by_appearance = 0;
  int wrong = 0;
  int ambiguous = 0;
  for (const dyslam::Loop& loop : backend.loops())
  {
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
  const Pose estimated = backend.optimizedTrajectory()[truth.size() - 1].pose;
  const Pose off = (truth.front().inverse() * truth.back()).inverse() *
                   backend.optimizedTrajectory()[0].pose.inverse() * estimated;
  std::printf(
      "appearance %-3s  loops %3d (by appearance %3d, false %d), ambiguous %3d, error at "
      "the end %.2f m\n",
      appearance ? "on" : "off", accepted, by_appearance, wrong, ambiguous,
      off.translation().norm());
}

void runThrough(const std::string& rawlog, const Drift& drift, bool appearance)
{
  dyslam::LoopCloserOptions loops;
  loops.appearance = appearance;
  dyslam::KeyframeStore keyframes;
  dyslam::Backend backend({}, loops, {}, keyframes);
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
    frame->motion.converged = true;
    frame->motion.information =
        dyslam::informationFromSigmas(std::max(1e-3, std::abs(drift.stretch) * length),
                                      std::max(1e-4, std::abs(drift.turn) * length));
    backend.addFrame(*frame);
  }
  backend.finish();
  report(backend, truth, appearance);
}
}  // namespace

int main(int argc, char** argv)
{
  if (argc != 4)
  {
    std::cerr << "usage: loop_drift_benchmark RAWLOG TURN_DEG_PER_100M STRETCH_PERCENT\n";
    return 1;
  }
  try
  {
    Drift drift;
    drift.turn = std::atof(argv[2]) * M_PI / 180 / 100;
    drift.stretch = std::atof(argv[3]) / 100;
    runThrough(argv[1], drift, false);
    runThrough(argv[1], drift, true);
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
