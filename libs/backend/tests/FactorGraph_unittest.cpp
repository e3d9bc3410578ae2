// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraph.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>

#include "NoisyDrive.h"

namespace dyslam
{
namespace
{
using test::diagonalInformation;
using test::NoisyDrive;

Pose at(double x, double yaw = 0)
{
  return poseFromYpr(x, 0, 0, yaw, 0, 0);
}

std::unique_ptr<Factor> odometryStep(std::size_t from, std::size_t to, double x = 1)
{
  return std::make_unique<OdometryFactor>(from, to, at(x), diagonalInformation(0.1, 0.01));
}

/** Three ego poses, a static object and a moving one seen at three scans, with noise. */
FactorGraph smallGraph(unsigned seed)
{
  NoisyDrive noise(seed);
  FactorGraph graph;
  const auto observe = [&](std::size_t keyframe, const Key& object, const Pose& T_map_object)
  {
    const Pose T = graph.pose(Key::ego(keyframe)).inverse() * T_map_object;
    graph.add(std::make_unique<ObservationFactor>(keyframe, object, noise.noisy(T, 0.1, 0.03),
                                                  diagonalInformation(0.1, 0.03)));
  };
  const Key parked = Key::staticObject(4);
  graph.addPose(parked, poseFromYpr(6, 3, 0, 0.3, 0, 0));
  for (std::size_t i = 0; i < 3; ++i)
  {
    graph.addPose(Key::ego(i), at(static_cast<double>(i), 0.1 * static_cast<double>(i)));
    if (i > 0)
    {
      const Pose T = graph.pose(Key::ego(i - 1)).inverse() * graph.pose(Key::ego(i));
      graph.add(std::make_unique<OdometryFactor>(i - 1, i, noise.noisy(T, 0.05, 0.01),
                                                 diagonalInformation(0.05, 0.01)));
    }
    observe(i, parked, graph.pose(parked));
    const Key moving = Key::objectPose(9, i);
    graph.addPose(moving, poseFromYpr(4 + 2 * static_cast<double>(i), -3, 0, 0, 0, 0));
    observe(i, moving, graph.pose(moving));
    if (i > 0)
    {
      Vector6 velocity = Vector6::Zero();
      velocity.x() = 4;
      graph.addVector(Key::objectVelocity(9, i), velocity);
      graph.add(
          std::make_unique<ObjectMotionFactor>(9, i - 1, i, 0.5, diagonalInformation(0.05, 0.05)));
    }
  }
  graph.add(std::make_unique<SmoothMotionFactor>(9, 1, 2, diagonalInformation(0.5, 0.5)));
  graph.setFixed(Key::ego(0), true);
  return graph;
}

/** J'J of the whitened residuals over the tangents of `keys`, built block by block. */
Eigen::MatrixXd denseInformation(const FactorGraph& graph, const std::vector<Key>& keys)
{
  std::map<Key, Eigen::Index> offset;
  for (const Key& key : keys)
  {
    offset.emplace(key, 6 * static_cast<Eigen::Index>(offset.size()));
  }
  const auto size = 6 * static_cast<Eigen::Index>(keys.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (const FactorGraph::FactorId id : graph.factorIds())
  {
    const Factor& factor = graph.factor(id);
    std::array<const double*, max_keys_per_factor> blocks{};
    Eigen::MatrixXd row = Eigen::MatrixXd::Zero(6, size);
    FactorJacobians jacobians;
    for (std::size_t i = 0; i < factor.keys().size(); ++i)
    {
      blocks[i] = graph.variables().at(factor.keys()[i]).block.data();
    }
    (void)factor.residual(blocks.data(), &jacobians);
    for (std::size_t i = 0; i < factor.keys().size(); ++i)
    {
      const auto found = offset.find(factor.keys()[i]);
      if (found != offset.end())
      {
        row.middleCols<6>(found->second) = jacobians[i];
      }
    }
    sum += row.transpose() * factor.information() * row;
  }
  return sum;
}

TEST(FactorGraph, VariablesAreAddedChangedAndRemoved)
{
  FactorGraph graph;
  graph.addPose(Key::ego(0), at(1, 0.5));
  Vector6 twist;
  twist << 1, 2, 3, 0.1, 0.2, 0.3;
  graph.addVector(Key::objectVelocity(3, 7), twist);
  EXPECT_TRUE(graph.pose(Key::ego(0)).isApprox(at(1, 0.5), 1e-12));
  EXPECT_EQ(graph.vector(Key::objectVelocity(3, 7)), twist);
  graph.setPose(Key::ego(0), at(2));
  EXPECT_TRUE(graph.pose(Key::ego(0)).isApprox(at(2), 1e-12));
  EXPECT_FALSE(graph.variables().at(Key::ego(0)).fixed);
  graph.setFixed(Key::ego(0), true);
  EXPECT_TRUE(graph.variables().at(Key::ego(0)).fixed);

  graph.addPose(Key::ego(1), at(3));
  graph.addPose(Key::ego(2), at(4));
  const auto first = graph.add(odometryStep(0, 1));
  const auto second = graph.add(odometryStep(1, 2));
  EXPECT_EQ(graph.factorsOf(Key::ego(1)), (std::vector<FactorGraph::FactorId>{first, second}));
  graph.remove(Key::ego(2));
  EXPECT_FALSE(graph.contains(Key::ego(2)));
  EXPECT_EQ(graph.factorIds(), std::vector<FactorGraph::FactorId>{first});
  EXPECT_EQ(graph.factorCount(), 1U);
  EXPECT_EQ(graph.factorsOf(Key::ego(1)), std::vector<FactorGraph::FactorId>{first});
  graph.removeFactor(first);
  EXPECT_EQ(graph.factorCount(), 0U);
  EXPECT_TRUE(graph.factorsOf(Key::ego(0)).empty());
  EXPECT_EQ(graph.chi2(), 0);
}

TEST(FactorGraph, WrongUseIsRefusedAndChangesNothing)
{
  FactorGraph graph;
  graph.addPose(Key::ego(0), at(0));
  EXPECT_THROW(graph.addPose(Key::ego(0), at(1)), std::invalid_argument);
  EXPECT_THROW(graph.addPose(Key::objectVelocity(1, 1), at(1)), std::invalid_argument);
  EXPECT_THROW(graph.addVector(Key::ego(1), Vector6::Zero()), std::invalid_argument);
  EXPECT_THROW(graph.addPose(Key::ego(1), at(std::nan(""))), std::invalid_argument);
  EXPECT_THROW(graph.addVector(Key::objectVelocity(1, 1),
                               Vector6::Constant(std::numeric_limits<double>::infinity())),
               std::invalid_argument);
  EXPECT_THROW(graph.setPose(Key::ego(0), at(std::nan(""))), std::invalid_argument);
  EXPECT_THROW(graph.add(odometryStep(0, 1)), std::invalid_argument);
  EXPECT_THROW((void)graph.pose(Key::ego(7)), std::out_of_range);
  EXPECT_THROW(graph.setFixed(Key::ego(7), true), std::out_of_range);
  EXPECT_THROW(graph.remove(Key::ego(7)), std::out_of_range);
  EXPECT_THROW(graph.removeFactor(0), std::out_of_range);
  EXPECT_THROW((void)graph.optimise({}, {Key::ego(7)}), std::out_of_range);
  EXPECT_THROW((void)graph.covariances({Key::ego(7)}), std::out_of_range);
  EXPECT_EQ(graph.variables().size(), 1U);
  EXPECT_EQ(graph.factorCount(), 0U);
  EXPECT_TRUE(graph.pose(Key::ego(0)).isApprox(at(0), 1e-12));
}

TEST(FactorGraph, ValuesOfTheOtherTypeAreRefused)
{
  FactorGraph graph;
  graph.addPose(Key::ego(0), at(0));
  graph.addVector(Key::objectVelocity(1, 1), Vector6::Zero());
  EXPECT_THROW(graph.setPose(Key::objectVelocity(1, 1), at(0)), std::invalid_argument);
}

TEST(FactorGraph, OptimumIsWhereTheGradientVanishes)
{
  FactorGraph graph = smallGraph(1);
  FactorGraphOptions options;
  options.object_loss = RobustLoss::none;
  options.tolerance = 1e-14;
  const double before = graph.chi2();
  const OptimisationResult result = graph.optimise(options);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_TRUE(result.warnings.empty());
  EXPECT_NEAR(result.initial_chi2, before, 1e-9 * before);
  EXPECT_NEAR(result.final_chi2, graph.chi2(), 1e-9 * before);
  EXPECT_LT(result.final_chi2, before);
  EXPECT_TRUE(graph.pose(Key::ego(0)).isApprox(at(0), 1e-12));
  for (const auto& [key, variable] : graph.variables())
  {
    for (int k = 0; k < 6 && !variable.fixed; ++k)
    {
      FactorGraph moved = smallGraph(1);
      for (const auto& [other, value] : graph.variables())
      {
        moved.setBlock(other, value.block);
      }
      constexpr double by = 1e-3;
      auto block = variable.block;
      block[static_cast<std::size_t>(k)] += by;
      key.isPose() ? moved.setPose(key, graph.pose(key) * expSE3(by * Vector6::Unit(k)))
                   : moved.setBlock(key, block);
      EXPECT_GT(moved.chi2(), result.final_chi2) << toString(key) << " " << k;
    }
  }
}

TEST(FactorGraph, CovariancesAreThoseOfTheDenseInverse)
{
  FactorGraph graph = smallGraph(2);
  (void)graph.optimise({});
  std::vector<Key> keys;
  for (const auto& [key, variable] : graph.variables())
  {
    if (!variable.fixed)
    {
      keys.push_back(key);
    }
  }
  const Eigen::MatrixXd covariance = denseInformation(graph, keys).inverse();
  const std::vector<Matrix6> all = graph.covariances(keys);
  ASSERT_EQ(all.size(), keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    const auto offset = 6 * static_cast<Eigen::Index>(i);
    const Matrix6 expected = covariance.block<6, 6>(offset, offset);
    EXPECT_LT((all[i] - expected).norm(), 1e-6 * expected.norm()) << toString(keys[i]);
  }
  // Fixed: none. Given the others: the inverse of its own block.
  EXPECT_EQ(graph.covariances({Key::ego(0)}).front(), Matrix6(Matrix6::Zero()));
  const Key parked = Key::staticObject(4);
  const Matrix6 conditional = denseInformation(graph, {parked}).inverse();
  EXPECT_LT((graph.covariances({parked}, {parked}).front() - conditional).norm(),
            1e-6 * conditional.norm());
  const std::vector<Matrix6> twice = graph.covariances({parked, parked});
  ASSERT_EQ(twice.size(), 2U);
  EXPECT_EQ(twice[0], twice[1]);
  EXPECT_LT(conditional.trace(), twice[0].trace());
}

/** Yaw and translation of the vertical, and half of the bias, are not measured. */
TEST(FactorGraph, CovariancesWithGravityAreThoseOfWhatItMeasures)
{
  FactorGraph graph = smallGraph(4);
  const Pose T_level_map = poseFromYpr(1, 2, 3, 0.4, 0.1, -0.2);
  const Eigen::Vector3d bias(0.03, -0.02, 0.01);
  graph.addPose(Key::vertical(), T_level_map);
  graph.addVector(Key::accelerometerBias(), Vector6::Zero());
  for (std::size_t i = 0; i < 3; ++i)
  {
    const Eigen::Matrix3d R_level_vehicle = T_level_map.linear() * graph.pose(Key::ego(i)).linear();
    const Eigen::Vector3d upwards =
        R_level_vehicle.transpose() * Eigen::Vector3d(0.05, -0.1, standard_gravity) + bias;
    graph.add(std::make_unique<GravityFactor>(i, upwards, diagonalInformation(0.02, 0.1)));
  }
  (void)graph.optimise({});
  std::vector<Key> keys;
  for (const auto& [key, variable] : graph.variables())
  {
    if (!variable.fixed)
    {
      keys.push_back(key);
    }
  }
  const auto size = 6 * static_cast<Eigen::Index>(keys.size());
  Eigen::MatrixXd measured = Eigen::MatrixXd::Zero(size, size - 7);  // columns: directions
  Eigen::Index column = 0;
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    Eigen::MatrixXd directions = Matrix6::Identity();
    if (keys[i] == Key::vertical())
    {
      directions = Eigen::MatrixXd::Zero(6, 2);
      directions.bottomRows(3) =
          graph.pose(keys[i]).linear().transpose() * Eigen::Matrix<double, 3, 2>::Identity();
    }
    else if (keys[i] == Key::accelerometerBias())
    {
      directions = Eigen::MatrixXd::Identity(6, 3);
    }
    measured.block(6 * static_cast<Eigen::Index>(i), column, 6, directions.cols()) = directions;
    column += directions.cols();
  }
  ASSERT_EQ(column, measured.cols());
  const Eigen::MatrixXd covariance =
      measured * (measured.transpose() * denseInformation(graph, keys) * measured).inverse() *
      measured.transpose();
  const std::vector<Matrix6> all = graph.covariances(keys);
  ASSERT_EQ(all.size(), keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i)
  {
    const auto offset = 6 * static_cast<Eigen::Index>(i);
    const Matrix6 expected = covariance.block<6, 6>(offset, offset);
    EXPECT_GT(expected.norm(), 0) << toString(keys[i]);
    EXPECT_LT((all[i] - expected).norm(), 1e-6 * expected.norm()) << toString(keys[i]);
  }
}

TEST(FactorGraph, UnconstrainedDirectionsHaveNoCovariance)
{
  FactorGraph graph = smallGraph(3);
  graph.setFixed(Key::ego(0), false);
  EXPECT_THROW((void)graph.covariances({Key::ego(1)}), std::runtime_error);
}

TEST(FactorGraph, OnlyTheNamedVariablesMove)
{
  FactorGraph graph = smallGraph(4);
  const FactorGraph before = smallGraph(4);
  const std::set<Key> free = {Key::ego(2), Key::objectPose(9, 2), Key::objectVelocity(9, 2)};
  const OptimisationResult result = graph.optimise({}, free);
  EXPECT_LT(result.final_chi2, result.initial_chi2);
  for (const auto& [key, variable] : graph.variables())
  {
    EXPECT_EQ(variable.block == before.variables().at(key).block, free.count(key) == 0)
        << toString(key);
  }
  // Fixed ones do not move even if they are named.
  graph.setFixed(Key::ego(2), true);
  const Pose fixed = graph.pose(Key::ego(2));
  (void)graph.optimise({}, {Key::ego(1), Key::ego(2)});
  EXPECT_EQ(graph.pose(Key::ego(2)).matrix(), fixed.matrix());
}

TEST(FactorGraph, UnconnectedPartIsReportedAndTheRestIsSolved)
{
  FactorGraph graph;
  for (std::size_t i = 0; i < 4; ++i)
  {
    graph.addPose(Key::ego(i), at(1.5 * static_cast<double>(i)));
  }
  graph.setFixed(Key::ego(0), true);
  graph.add(odometryStep(0, 1));
  graph.add(odometryStep(2, 3));
  graph.addPose(Key::staticObject(5), at(100));
  const OptimisationResult result = graph.optimise({});
  EXPECT_TRUE(result.converged);
  ASSERT_EQ(result.warnings.size(), 2U);
  EXPECT_EQ(result.warnings[0],
            "x2 and the variables connected to it have no fixed variable: x2 is held where it is");
  EXPECT_EQ(result.warnings[1].find("s5 "), 0U) << result.warnings[1];
  EXPECT_NEAR(graph.pose(Key::ego(1)).translation().x(), 1, 1e-6);
  EXPECT_NEAR(graph.pose(Key::ego(2)).translation().x(), 3, 1e-12);  // held
  EXPECT_NEAR(graph.pose(Key::ego(3)).translation().x(), 4, 1e-6);
  EXPECT_NEAR(graph.pose(Key::staticObject(5)).translation().x(), 100, 1e-12);
}

TEST(FactorGraph, EmptyAndFixedGraphsConverge)
{
  FactorGraph graph;
  EXPECT_TRUE(graph.optimise({}).converged);
  graph.addPose(Key::ego(0), at(0));
  EXPECT_TRUE(graph.optimise({}).converged);
  graph.setFixed(Key::ego(0), true);
  EXPECT_TRUE(graph.optimise({}).converged);
  EXPECT_TRUE(graph.optimise({}, {}).converged);
}

TEST(FactorGraph, FactorsBetweenFixedVariablesCountBeforeAndAfter)
{
  for (const RobustLoss loss : {RobustLoss::none, RobustLoss::dcs})
  {
    FactorGraph graph;
    for (std::size_t i = 0; i < 3; ++i)
    {
      graph.addPose(Key::ego(i), at(1.5 * static_cast<double>(i)));
      graph.setFixed(Key::ego(i), i < 2);
    }
    graph.add(odometryStep(0, 1));
    graph.add(odometryStep(1, 2));
    const double before = graph.chi2();
    FactorGraphOptions options;
    options.loop_loss = loss;
    const OptimisationResult result = graph.optimise(options);
    EXPECT_NEAR(result.initial_chi2, before, 1e-9 * before);
    EXPECT_NEAR(result.final_chi2, 0.5 * before, 1e-6 * before);
    EXPECT_EQ(result.final_chi2, graph.chi2());
  }
}

TEST(FactorGraph, TwoRunsGiveTheSameBytes)
{
  NoisyDrive drive(5);
  const auto loops = drive.threeTrueLoops();
  FactorGraph graphs[2] = {drive.graph(loops), drive.graph(loops)};
  for (FactorGraph& graph : graphs)
  {
    (void)graph.optimise({});
  }
  for (const auto& [key, variable] : graphs[0].variables())
  {
    EXPECT_EQ(variable.block, graphs[1].variables().at(key).block);
  }
}

TEST(FactorGraph, LoopsLowerTheErrorOfABiasedOdometry)
{
  for (const RobustLoss loss : {RobustLoss::none, RobustLoss::dcs})
  {
    // The odometry is overconfident, and drifts by metres.
    NoisyDrive drive(6);
    for (Pose& motion : drive.steps)
    {
      motion = motion * poseFromYpr(0.01, 0, 0, 0.0006, 0, 0);
    }
    FactorGraph graph = drive.graph(drive.threeTrueLoops());
    const double drift = test::largestError(graph, drive.truth);
    FactorGraphOptions options;
    options.loop_loss = loss;
    const OptimisationResult result = graph.optimise(options);
    EXPECT_EQ(result.false_loops, 0U) << static_cast<int>(loss);
    for (const FactorGraph::FactorId id : graph.factorIds())
    {
      if (graph.factor(id).is<LoopFactor>())
      {
        EXPECT_LT(graph.whitenedResidual(id), 8) << static_cast<int>(loss);
      }
    }
    EXPECT_GT(drift, 3);
    EXPECT_LT(test::largestError(graph, drive.truth), 0.5 * drift) << static_cast<int>(loss);
  }
}

TEST(FactorGraph, OneFalseLoopBendsOrdinaryLeastSquaresAlone)
{
  NoisyDrive drive(7);
  std::vector<test::LoopMeasurement> loops = drive.threeTrueLoops();
  const std::vector<test::LoopMeasurement> true_loops = loops;
  loops.push_back({20, 200, poseFromYpr(3, -4, 1, 1, 0, 0)});
  std::map<RobustLoss, double> shift;
  for (const RobustLoss loss : {RobustLoss::none, RobustLoss::cauchy, RobustLoss::dcs})
  {
    FactorGraph clean = drive.graph(true_loops);
    FactorGraph graph = drive.graph(loops);
    FactorGraphOptions options;
    options.loop_loss = loss;
    (void)clean.optimise(options);
    (void)graph.optimise(options);
    shift[loss] = test::largestShift(clean, graph);
  }
  EXPECT_GT(shift[RobustLoss::none], 1);
  EXPECT_LT(shift[RobustLoss::dcs], 0.01);
  EXPECT_LT(shift[RobustLoss::cauchy], 0.01);
}

TEST(FactorGraph, ContradictingLoopsDoNotBreakTheRest)
{
  // Two registrations of one pair of keyframes: one right, one wrong.
  NoisyDrive drive(8);
  std::vector<test::LoopMeasurement> loops = drive.threeTrueLoops();
  FactorGraph clean = drive.graph(loops);
  (void)clean.optimise({});
  test::LoopMeasurement wrong = loops[1];
  wrong.T_from_to = wrong.T_from_to * poseFromYpr(-4, 3, 0, 0.5, 0, 0);
  loops.push_back(wrong);
  FactorGraph graph = drive.graph(loops);
  const OptimisationResult result = graph.optimise({});
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_LT(test::largestShift(clean, graph), 0.01);
}
}  // namespace
}  // namespace dyslam
