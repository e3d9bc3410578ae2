// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <random>
#include <vector>

namespace dyslam::test
{
inline Matrix6 diagonalInformation(double translation_sigma, double rotation_sigma)
{
  Vector6 d;
  d << Eigen::Vector3d::Constant(1 / (translation_sigma * translation_sigma)),
      Eigen::Vector3d::Constant(1 / (rotation_sigma * rotation_sigma));
  return d.asDiagonal();
}

inline Matrix6 randomInformation(std::mt19937& rng)
{
  std::normal_distribution<double> n;
  const Matrix6 a = Matrix6::NullaryExpr([&] { return n(rng); });
  return a * a.transpose() + 0.1 * Matrix6::Identity();
}

/** A measured motion between two keyframes. */
struct LoopMeasurement
{
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to = Pose::Identity();
};

/** Two rounds of a course of 225 m with a keyframe every 1.5 m, measured by odometry with white
 * noise. */
struct NoisyDrive
{
  static constexpr std::size_t per_round = 150;
  static constexpr double loop_sigma = 0.03;            //!< sigma of a loop's translation [m]
  static constexpr double loop_rotation_sigma = 0.002;  //!< sigma of a loop's rotation [rad]

  explicit NoisyDrive(unsigned seed, double sigma = 0.01, double rotation_sigma = 0.0005)
      : rng(seed), odometry_information(diagonalInformation(sigma, rotation_sigma))
  {
    for (std::size_t i = 0; i < 2 * per_round; ++i)
    {
      const double angle = 2 * M_PI * static_cast<double>(i) / per_round;
      truth.push_back(poseFromYpr(45 * std::cos(angle), 25 * std::sin(angle), std::sin(2 * angle),
                                  std::atan2(25 * std::cos(angle), -45 * std::sin(angle)), 0, 0));
    }
    for (std::size_t i = 1; i < truth.size(); ++i)
    {
      steps.push_back(noisy(truth[i - 1].inverse() * truth[i], sigma, rotation_sigma));
    }
  }

  Pose noisy(const Pose& pose, double sigma, double rotation_sigma)
  {
    std::normal_distribution<double> n;
    Vector6 x = Vector6::NullaryExpr([&] { return n(rng); });
    x.head<3>() *= sigma;
    x.tail<3>() *= rotation_sigma;
    return pose * expSE3(x);
  }

  /** Noisy measurement of the relative pose of two keyframes, as by a registration. */
  LoopMeasurement trueLoop(std::size_t from, std::size_t to)
  {
    return {from, to, noisy(truth[from].inverse() * truth[to], loop_sigma, loop_rotation_sigma)};
  }
  std::vector<LoopMeasurement> threeTrueLoops()
  {
    return {trueLoop(8, 158), trueLoop(70, 221), trueLoop(118, 267)};
  }

  [[nodiscard]] FactorGraph graph(const std::vector<LoopMeasurement>& loops) const
  {
    FactorGraph graph;
    Pose pose = truth.front();
    graph.addPose(Key::ego(0), pose);
    graph.setFixed(Key::ego(0), true);
    for (std::size_t i = 0; i < steps.size(); ++i)
    {
      pose = pose * steps[i];
      graph.addPose(Key::ego(i + 1), pose);
      const auto weak = weak_steps.find(i);
      graph.add(std::make_unique<OdometryFactor>(
          i, i + 1, steps[i], weak == weak_steps.end() ? odometry_information : weak->second));
    }
    for (const LoopMeasurement& loop : loops)
    {
      graph.add(std::make_unique<LoopFactor>(loop.from, loop.to, loop.T_from_to,
                                             diagonalInformation(loop_sigma, loop_rotation_sigma)));
    }
    return graph;
  }

  std::mt19937 rng;
  Matrix6 odometry_information;
  std::vector<Pose> truth;
  std::vector<Pose> steps;                    //!< measured motion from keyframe i to i + 1
  std::map<std::size_t, Matrix6> weak_steps;  //!< information of steps that were not measured
};

/** Largest distance between the ego poses of two graphs [m]. */
inline double largestShift(const FactorGraph& a, const FactorGraph& b)
{
  double largest = 0;
  for (const auto& [key, variable] : a.variables())
  {
    if (key.kind == VariableKind::ego_pose)
    {
      largest = std::max(largest, (a.pose(key).translation() - b.pose(key).translation()).norm());
    }
  }
  return largest;
}

inline double largestError(const FactorGraph& graph, const std::vector<Pose>& truth)
{
  double largest = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
  {
    largest =
        std::max(largest, (graph.pose(Key::ego(i)).translation() - truth[i].translation()).norm());
  }
  return largest;
}
}  // namespace dyslam::test
