// SPDX-License-Identifier: BSD-3-Clause
// Processor time of loop closing as a run grows: rounds of one block, with a loop to the previous
// round at every other keyframe. False loops are searched for as in a run.
//   loop_closing_benchmark [--keyframes N] [--newest N]      keyframes moved at once; 0: all
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <random>
#include <string>

#include "loops/LoopCorrection.h"

namespace
{
using namespace dyslam;

constexpr std::size_t round_keyframes = 250;
constexpr double keyframe_distance = 1.5;  // distance between keyframes [m]
constexpr double odometry_sigma = 0.01;    // sigma per keyframe [m]; rotation: a twentieth [rad]
constexpr double loop_sigma = 0.02;        // sigma of a loop [m]; rotation: a twentieth [rad]

/** A motion with noise, and its stated information. */
class Noise
{
 public:
  [[nodiscard]] Pose disturb(const Pose& motion, double sigma)
  {
    std::normal_distribution<double> normal(0, sigma);
    const auto angle = [&] { return normal(random_) / 20; };
    const double yaw = angle();
    const double pitch = angle();
    const double roll = angle();
    return motion *
           poseFromYpr(normal(random_), normal(random_), normal(random_), yaw, pitch, roll);
  }
  [[nodiscard]] static Matrix6 information(double sigma)
  {
    Vector6 sigmas;
    sigmas << Eigen::Vector3d::Constant(sigma), Eigen::Vector3d::Constant(sigma / 20);
    return sigmas.cwiseAbs2().cwiseInverse().asDiagonal();
  }

 private:
  std::mt19937 random_{1};
};

double processorSeconds()
{
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}
}  // namespace

int main(int argc, char** argv)
{
  std::size_t keyframes = 12000;
  BackendOptions options;
  for (int i = 1; i + 1 < argc; i += 2)
  {
    const int value = std::atoi(argv[i + 1]);
    if (std::string(argv[i]) == "--newest")
    {
      options.correction_keyframes = value;
    }
    else
    {
      keyframes = static_cast<std::size_t>(value);
    }
  }
  constexpr double turn = 2 * 3.14159265358979 / round_keyframes;
  const Pose step = poseFromYpr(keyframe_distance, 0, 0, turn, 0, 0);
  Noise noise;
  FactorGraph graph;
  LoopCorrection correction(options, FactorGraphOptions{}, graph);
  graph.addPose(Key::ego(0), Pose::Identity());
  graph.setFixed(Key::ego(0), true);
  std::size_t loops = 0;
  std::size_t newest = 0;  // corrections of the newest keyframes, of all
  std::size_t all = 0;
  double since = processorSeconds();
  std::printf("keyframes  loops  newest  all  ms per keyframe  left out\n");
  for (std::size_t i = 1; i < keyframes; ++i)
  {
    const Pose measured = noise.disturb(step, odometry_sigma);
    graph.addPose(Key::ego(i), graph.pose(Key::ego(i - 1)) * measured);
    graph.add(
        std::make_unique<OdometryFactor>(i - 1, i, measured, Noise::information(odometry_sigma)));
    if (i >= round_keyframes && i % 2 == 0)
    {
      correction.add(graph.add(std::make_unique<LoopFactor>(
          i - round_keyframes, i, noise.disturb(Pose::Identity(), loop_sigma),
          Noise::information(loop_sigma))));
      ++loops;
      if (correction.isDue())
      {
        ++(correction.correct(i + 1, {}) > 0 ? newest : all);
      }
    }
    if ((i + 1) % 1000 == 0)
    {
      const double now = processorSeconds();
      std::printf("%9zu  %5zu  %6zu  %3zu  %15.2f  %8zu\n", i + 1, loops, newest, all, now - since,
                  correction.last().false_loops);
      std::fflush(stdout);
      since = now;
      newest = all = 0;
    }
  }
  return 0;
}
