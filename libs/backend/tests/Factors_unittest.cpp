// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/GnssFactor.h>
#include <dyslam/backend/factors/GravityFactor.h>
#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/ObjectMotionFactor.h>
#include <dyslam/backend/factors/ObservationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/backend/factors/SmoothMotionFactor.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "NoisyDrive.h"
#include "graph/CovarianceInverse.h"
#include "graph/PoseManifold.h"

namespace dyslam
{
namespace
{
constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

Vector6 randomTwist(std::mt19937& rng, double translation, double rotation)
{
  std::uniform_real_distribution<double> u(-1, 1);
  Vector6 x = Vector6::NullaryExpr([&] { return u(rng); });
  x.head<3>() *= translation;
  x.tail<3>() *= rotation;
  return x;
}

/** Values for the variables of a factor. */
struct Blocks
{
  std::array<std::array<double, pose_block_size>, max_keys_per_factor> values{};

  [[nodiscard]] std::array<const double*, max_keys_per_factor> pointers() const
  {
    return {values[0].data(), values[1].data(), values[2].data()};
  }
  void set(std::size_t i, const Pose& pose) { packPose(pose, values[i].data()); }
  void set(std::size_t i, const Vector6& twist) { Eigen::Map<Vector6>(values[i].data()) = twist; }
  [[nodiscard]] Blocks moved(std::size_t i, bool is_pose, const Vector6& by) const
  {
    Blocks result = *this;
    if (is_pose)
    {
      PoseManifold().Plus(values[i].data(), by.data(), result.values[i].data());
    }
    else
    {
      Eigen::Map<Vector6>(result.values[i].data()) += by;
    }
    return result;
  }
};

Vector6 residualAt(const Factor& factor, const Blocks& blocks)
{
  return factor.residual(blocks.pointers().data(), nullptr);
}

/** Compares the derivatives of a factor with central differences over the manifold. */
void expectNumericalJacobians(const Factor& factor, const Blocks& blocks)
{
  constexpr double step = 1e-6;
  FactorJacobians jacobians;
  const Vector6 residual = factor.residual(blocks.pointers().data(), &jacobians);
  EXPECT_EQ(residual, residualAt(factor, blocks)) << "depends on what is asked for";
  for (std::size_t i = 0; i < factor.keys().size(); ++i)
  {
    const bool is_pose = factor.keys()[i].isPose();
    Matrix6 numeric;
    for (int k = 0; k < 6; ++k)
    {
      const Vector6 by = step * Vector6::Unit(k);
      numeric.col(k) = (residualAt(factor, blocks.moved(i, is_pose, by)) -
                        residualAt(factor, blocks.moved(i, is_pose, -by))) /
                       (2 * step);
    }
    EXPECT_LT((jacobians[i] - numeric).norm(), 1e-6 * (1 + numeric.norm()))
        << toString(factor.keys()[i]) << " of " << factor.type().name;
  }
}

/** Two poses whose relative pose is the measurement but for a twist of this size. */
template <typename MakeFactor>
void checkRelativePoses(const MakeFactor& make_factor)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    std::mt19937 rng(seed);
    const Pose T_a_b = expSE3(randomTwist(rng, 5, 1.5));
    const Pose T_a = expSE3(randomTwist(rng, 30, 2));
    const double size = seed % 4 == 0 ? 0 : 0.5 * (seed % 4);
    const Vector6 error = randomTwist(rng, size, size);
    Blocks blocks;
    blocks.set(0, T_a);
    blocks.set(1, T_a * T_a_b * expSE3(error));
    const auto factor = make_factor(T_a_b, test::randomInformation(rng));
    EXPECT_LT((residualAt(*factor, blocks) - error).norm(), 1e-9);
    expectNumericalJacobians(*factor, blocks);
  }
}

TEST(OdometryFactor, JacobiansMatchNumericalDerivatives)
{
  checkRelativePoses([](const Pose& T, const Matrix6& information)
                     { return std::make_unique<OdometryFactor>(3, 4, T, information); });
}

TEST(LoopFactor, JacobiansMatchNumericalDerivatives)
{
  checkRelativePoses([](const Pose& T, const Matrix6& information)
                     { return std::make_unique<LoopFactor>(3, 40, T, information); });
}

TEST(LocalisationFactor, JacobiansMatchNumericalDerivatives)
{
  checkRelativePoses([](const Pose& T, const Matrix6& information)
                     { return std::make_unique<LocalisationFactor>(3, T, information); });
}

TEST(ObservationFactor, JacobiansMatchNumericalDerivatives)
{
  for (const Key& key : {Key::staticObject(7), Key::objectPose(7, 12)})
  {
    checkRelativePoses([&](const Pose& T, const Matrix6& information)
                       { return std::make_unique<ObservationFactor>(3, key, T, information); });
  }
}

TEST(GnssFactor, JacobiansMatchNumericalDerivatives)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    std::mt19937 rng(seed);
    Blocks blocks;
    const Pose T_map_vehicle = expSE3(randomTwist(rng, 30, 2));
    const Pose T_enu_map = expSE3(randomTwist(rng, 30, 1));
    blocks.set(0, T_map_vehicle);
    blocks.set(1, T_enu_map);
    const Eigen::Vector3d antenna(0.4, -0.1, 1.2);
    const Eigen::Vector3d error(2, -1, 0.5);
    const GnssFactor factor(3, T_enu_map * T_map_vehicle * antenna - error, antenna,
                            test::randomInformation(rng));
    const Vector6 residual = residualAt(factor, blocks);
    EXPECT_LT((residual.head<3>() - error).norm(), 1e-9);
    EXPECT_NEAR(residual.segment<2>(3).norm(), std::sin(std::acos(T_enu_map.linear()(2, 2))), 1e-9);
    expectNumericalJacobians(factor, blocks);
    const GnssFactor tilted(3, {0, 0, 0}, antenna, test::randomInformation(rng),
                            T_enu_map.linear().row(2).transpose());
    EXPECT_LT(residualAt(tilted, blocks).segment<2>(3).norm(), 1e-9) << "is upwards";
    expectNumericalJacobians(tilted, blocks);
  }
  EXPECT_THROW(GnssFactor(3, {nan_value, 0, 0}, {0, 0, 0}, Matrix6::Identity()),
               std::invalid_argument);
}

TEST(GravityFactor, JacobiansMatchNumericalDerivatives)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    std::mt19937 rng(seed);
    Blocks blocks;
    const Pose T_map_vehicle = expSE3(randomTwist(rng, 30, 2));
    const Pose T_level_map = expSE3(randomTwist(rng, 30, 1));
    Vector6 bias = Vector6::Zero();
    bias.head<3>() = randomTwist(rng, 0.5, 1).head<3>();
    blocks.set(0, T_map_vehicle);
    blocks.set(1, T_level_map);
    blocks.set(2, bias);
    const Eigen::Vector3d level(0.1, -0.05, 0.98);
    const Eigen::Vector3d upwards =
        standard_gravity * ((T_level_map * T_map_vehicle).linear().transpose() * level) +
        bias.head<3>();
    const GravityFactor factor(3, upwards, test::randomInformation(rng));
    const Vector6 residual = residualAt(factor, blocks);
    EXPECT_LT((residual.head<2>() - level.head<2>()).norm(), 1e-9);
    EXPECT_EQ(residual.segment<3>(2), bias.head<3>());
    expectNumericalJacobians(factor, blocks);
  }
  EXPECT_THROW(GravityFactor(3, {nan_value, 0, 9.8}, Matrix6::Identity()), std::invalid_argument);
}

TEST(ObjectMotionFactor, JacobiansMatchNumericalDerivatives)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    std::mt19937 rng(seed);
    const double dt = seed % 2 == 0 ? 0.1 : 0.7;
    const Vector6 velocity = randomTwist(rng, 20, 1);
    const Vector6 error = randomTwist(rng, 0.5, 0.1);
    const Pose T_from = expSE3(randomTwist(rng, 30, 2));
    Blocks blocks;
    blocks.set(0, T_from);
    blocks.set(1, T_from * expSE3(dt * velocity + error));
    blocks.set(2, velocity);
    const ObjectMotionFactor factor(7, 11, 12, dt, test::randomInformation(rng));
    EXPECT_LT((residualAt(factor, blocks) - error).norm(), 1e-9);
    expectNumericalJacobians(factor, blocks);
  }
}

TEST(SmoothMotionFactor, JacobiansMatchNumericalDerivatives)
{
  for (unsigned seed = 1; seed <= 20; ++seed)
  {
    std::mt19937 rng(seed);
    const Vector6 before = randomTwist(rng, 20, 1);
    const Vector6 after = randomTwist(rng, 20, 1);
    Blocks blocks;
    blocks.set(0, before);
    blocks.set(1, after);
    const SmoothMotionFactor factor(7, 11, 12, test::randomInformation(rng));
    EXPECT_LT((residualAt(factor, blocks) - (after - before)).norm(), 1e-12);
    expectNumericalJacobians(factor, blocks);
  }
}

TEST(Factor, WhiteningIsTheUpperRootOfTheInformation)
{
  // The lower Cholesky factor would pass for diagonal information only.
  std::mt19937 rng(5);
  const Matrix6 information = test::randomInformation(rng);
  const OdometryFactor factor(0, 1, Pose::Identity(), information);
  EXPECT_TRUE(factor.whitening().isUpperTriangular());
  EXPECT_LT((factor.information() - information).norm(), 1e-12 * information.norm());
  const Vector6 x = randomTwist(rng, 1, 1);
  EXPECT_NEAR((factor.whitening() * x).squaredNorm(), x.dot(information * x), 1e-12);
}

TEST(CovarianceInverse, IsTheInverseOrAtLeastPositiveDefinite)
{
  std::mt19937 generator(1);
  std::normal_distribution<double> normal;
  for (int exponent = -30; exponent <= 30; ++exponent)
  {
    Matrix6 random;
    for (Eigen::Index i = 0; i < random.size(); ++i)
    {
      random.data()[i] = normal(generator);
    }
    const Matrix6 axes = random.householderQr().householderQ();
    Vector6 variances = Vector6::Constant(1e-6);
    variances[5] = std::pow(10.0, exponent);
    const Matrix6 product = axes * variances.asDiagonal() * axes.transpose();
    const Matrix6 covariance = 0.5 * (product + product.transpose());
    const Matrix6 information = informationFromCovariance(covariance);
    EXPECT_TRUE(information == information.transpose()) << exponent;
    EXPECT_EQ(information.llt().info(), Eigen::Success) << exponent;
    if (std::abs(exponent + 6) < 6)
    {
      EXPECT_TRUE((information * covariance).isIdentity(1e-6)) << exponent;
    }
  }
}

TEST(Factor, KeysAndTypesAreTold)
{
  const Matrix6 one = Matrix6::Identity();
  const ObjectMotionFactor motion(7, 11, 12, 0.1, one);
  ASSERT_EQ(motion.keys().size(), 3U);
  EXPECT_EQ(motion.keys()[0], Key::objectPose(7, 11));
  EXPECT_EQ(motion.keys()[1], Key::objectPose(7, 12));
  EXPECT_EQ(motion.keys()[2], Key::objectVelocity(7, 12));
  EXPECT_EQ(motion.dt(), 0.1);
  EXPECT_TRUE(motion.is<ObjectMotionFactor>());
  EXPECT_TRUE(SmoothMotionFactor(7, 11, 12, one).is<SmoothMotionFactor>());
  EXPECT_TRUE(LoopFactor(0, 9, Pose::Identity(), one).is<LoopFactor>());
  EXPECT_TRUE(OdometryFactor(0, 1, Pose::Identity(), one).is<OdometryFactor>());
  const LocalisationFactor localised(2, Pose::Identity(), one);
  EXPECT_TRUE(localised.is<LocalisationFactor>());
  EXPECT_EQ(toString(localised.keys()[0]) + " " + toString(localised.keys()[1]), "m x2");
  const ObservationFactor seen(2, Key::staticObject(4, 1), Pose::Identity(), one);
  EXPECT_TRUE(seen.is<ObservationFactor>());
  EXPECT_EQ(toString(seen.keys()[0]) + " " + toString(seen.keys()[1]), "x2 s4#1");
  EXPECT_EQ(toString(Key::objectPose(4, 123)) + " " + toString(Key::objectVelocity(4, 123)),
            "l4@123 v4@123");
}

template <typename Make>
std::string messageOf(const Make& make)
{
  try
  {
    make();
  }
  catch (const std::invalid_argument& error)
  {
    return error.what();
  }
  return "no error";
}

void expectMessage(const std::string& message, const std::string& part)
{
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Factor, BadInformationIsNamed)
{
  Matrix6 indefinite = Matrix6::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 2;
  Matrix6 singular = Matrix6::Identity();
  singular(5, 5) = 0;
  Matrix6 skew = Matrix6::Identity();
  skew(0, 5) = 0.5;
  for (const Matrix6& bad : {indefinite, singular, skew, Matrix6(-Matrix6::Identity())})
  {
    expectMessage(messageOf([&] { OdometryFactor(3, 4, Pose::Identity(), bad); }),
                  "factor x3 -> x4: its information is not positive definite");
    expectMessage(messageOf([&] { SmoothMotionFactor(7, 1, 2, bad); }),
                  "factor v7@1 -> v7@2: its information is not positive definite");
  }
  for (const double bad : {nan_value, std::numeric_limits<double>::infinity()})
  {
    Matrix6 information = Matrix6::Identity();
    information(2, 2) = bad;
    expectMessage(messageOf([&] { ObjectMotionFactor(7, 1, 2, 0.1, information); }),
                  "factor l7@1 -> l7@2 -> v7@2: its information has numbers that are not finite");
  }
}

TEST(Factor, BadMeasurementsKeysAndTimesAreNamed)
{
  const Matrix6 one = Matrix6::Identity();
  Pose bad = Pose::Identity();
  bad.translation().x() = nan_value;
  expectMessage(messageOf([&] { LoopFactor(3, 9, bad, one); }),
                "factor x3 -> x9: its measurement has numbers that are not finite");
  expectMessage(messageOf([&] { OdometryFactor(3, 3, Pose::Identity(), one); }),
                "connects a variable to itself");
  expectMessage(messageOf([&] { SmoothMotionFactor(7, 3, 3, one); }),
                "connects a variable to itself");
  for (const double dt : {0.0, -0.1, nan_value, std::numeric_limits<double>::infinity()})
  {
    expectMessage(messageOf([&] { ObjectMotionFactor(7, 1, 2, dt, one); }),
                  "its time step must be");
  }
  for (const Key& key : {Key::ego(5), Key::objectVelocity(7, 5)})
  {
    expectMessage(messageOf([&] { ObservationFactor(3, key, Pose::Identity(), one); }),
                  "observation of " + toString(key) + ": not an object's pose");
  }
}
}  // namespace
}  // namespace dyslam
