// SPDX-License-Identifier: BSD-3-Clause
#include "graph/EdgeError.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <memory>
#include <random>

#include "graph/EdgeCost.h"
#include "graph/RobustLosses.h"

namespace dyslam
{
namespace
{
constexpr double step = 1e-6;

Pose randomPose(std::mt19937& rng, double translation, double rotation)
{
  std::uniform_real_distribution<double> u(-1, 1);
  Vector6 x = Vector6::NullaryExpr([&] { return u(rng); });
  x.head<3>() *= translation;
  x.tail<3>() *= rotation;
  return expSE3(x);
}

GraphEdge randomEdge(std::mt19937& rng)
{
  std::normal_distribution<double> n;
  GraphEdge edge;
  edge.T_from_to = randomPose(rng, 5, 1);
  const Matrix6 a = Matrix6::NullaryExpr([&] { return n(rng); });
  edge.information = a * a.transpose() + 0.1 * Matrix6::Identity();
  return edge;
}

class EdgeErrorOf : public ::testing::TestWithParam<ErrorCoordinates>
{
};

TEST_P(EdgeErrorOf, JacobiansMatchNumericalDerivatives)
{
  std::mt19937 rng(1);
  for (const double error : {0.0, 1e-4, 0.1, 1.0})
  {
    for (int trial = 0; trial < 10; ++trial)
    {
      const Pose T_i = randomPose(rng, 10, 1.5);
      const Pose Z = randomPose(rng, 5, 1);
      const Pose T_j = T_i * Z * randomPose(rng, 3 * error, error);
      Matrix6 by_i;
      Matrix6 by_j;
      (void)edgeError(GetParam(), Z, T_i, T_j, &by_i, &by_j);
      Matrix6 numeric_i;
      Matrix6 numeric_j;
      for (int k = 0; k < 6; ++k)
      {
        const Pose plus = expSE3(step * Vector6::Unit(k));
        const Pose minus = expSE3(-step * Vector6::Unit(k));
        numeric_i.col(k) = (edgeError(GetParam(), Z, T_i * plus, T_j) -
                            edgeError(GetParam(), Z, T_i * minus, T_j)) /
                           (2 * step);
        numeric_j.col(k) = (edgeError(GetParam(), Z, T_i, T_j * plus) -
                            edgeError(GetParam(), Z, T_i, T_j * minus)) /
                           (2 * step);
      }
      EXPECT_LT((by_i - numeric_i).norm(), 1e-6 * (1 + numeric_i.norm())) << error;
      EXPECT_LT((by_j - numeric_j).norm(), 1e-6 * (1 + numeric_j.norm())) << error;
    }
  }
}

TEST_P(EdgeErrorOf, AgreesWithTheLogarithmToFirstOrder)
{
  std::mt19937 rng(2);
  for (int trial = 0; trial < 10; ++trial)
  {
    const Pose T_i = randomPose(rng, 10, 1.5);
    const Pose Z = randomPose(rng, 5, 1);
    const Pose E = randomPose(rng, 1e-4, 1e-4);
    EXPECT_LT((edgeError(GetParam(), Z, T_i, T_i * Z * E) - logSE3(E)).norm(), 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Coordinates,
                         EdgeErrorOf,
                         ::testing::Values(ErrorCoordinates::log,
                                           ErrorCoordinates::split_log,
                                           ErrorCoordinates::quaternion));

/** Checks a cost function's Jacobians through the manifold, as Ceres uses them. */
void checkCost(const ceres::CostFunction& cost,
               const ceres::Manifold& manifold,
               std::vector<std::vector<double>> blocks)
{
  const auto residual_count = cost.num_residuals();
  const auto width = manifold.AmbientSize();
  const auto tangent = manifold.TangentSize();
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::VectorXd residuals(residual_count);
  RowMatrix J[2] = {RowMatrix(residual_count, width), RowMatrix(residual_count, width)};
  double* jacobians[2] = {J[0].data(), J[1].data()};
  const double* pointers[2] = {blocks[0].data(), blocks[1].data()};
  ASSERT_TRUE(cost.Evaluate(pointers, residuals.data(), jacobians));
  for (int b = 0; b < 2; ++b)
  {
    RowMatrix plus_jacobian(width, tangent);
    manifold.PlusJacobian(pointers[b], plus_jacobian.data());
    const Eigen::MatrixXd analytic = J[b] * plus_jacobian;
    Eigen::MatrixXd numeric(residual_count, tangent);
    for (int k = 0; k < tangent; ++k)
    {
      Eigen::VectorXd ends[2] = {Eigen::VectorXd(residual_count), Eigen::VectorXd(residual_count)};
      for (int side = 0; side < 2; ++side)
      {
        Eigen::VectorXd delta = (side == 0 ? step : -step) * Eigen::VectorXd::Unit(tangent, k);
        std::vector<double> moved(static_cast<std::size_t>(width));
        manifold.Plus(pointers[b], delta.data(), moved.data());
        const double* shifted[2] = {pointers[0], pointers[1]};
        shifted[b] = moved.data();
        ASSERT_TRUE(cost.Evaluate(shifted, ends[side].data(), nullptr));
      }
      numeric.col(k) = (ends[0] - ends[1]) / (2 * step);
    }
    EXPECT_LT((analytic - numeric).norm(), 1e-5 * (1 + numeric.norm())) << "block " << b;
  }
}

TEST(EdgeCost, JacobiansMatchNumericalDerivatives)
{
  std::mt19937 rng(3);
  const PoseManifold manifold;
  for (int trial = 0; trial < 10; ++trial)
  {
    const GraphEdge edge = randomEdge(rng);
    std::vector<std::vector<double>> blocks(2, std::vector<double>(pose_block_size));
    const Pose T_i = randomPose(rng, 10, 1);
    packPose(T_i, blocks[0].data());
    packPose(T_i * edge.T_from_to * randomPose(rng, 1, 0.3), blocks[1].data());
    for (const auto coordinates : {ErrorCoordinates::log, ErrorCoordinates::quaternion})
    {
      checkCost(*makeEdgeCost(coordinates, edge), manifold, blocks);
    }
  }
}

TEST(EdgeCost, PlanarJacobiansMatchNumericalDerivatives)
{
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(-1, 1);
  const ceres::EuclideanManifold<3> manifold;
  for (int trial = 0; trial < 10; ++trial)
  {
    GraphEdge edge = randomEdge(rng);
    edge.T_from_to = poseFromYpr(3 * u(rng), 3 * u(rng), 0, 3 * u(rng), 0, 0);
    const std::vector<std::vector<double>> blocks = {{u(rng), u(rng), u(rng)},
                                                     {u(rng), u(rng), u(rng)}};
    checkCost(*makePlanarEdgeCost(edge), manifold, blocks);
  }
}

TEST(EdgeCost, WhitenedErrorHasTheFullQuadraticForm)
{
  // matrixL() instead of matrixU() would pass for diagonal information only.
  std::mt19937 rng(5);
  const GraphEdge edge = randomEdge(rng);
  const Pose T_i = randomPose(rng, 10, 1);
  const Pose T_j = randomPose(rng, 10, 1);
  double blocks[2][pose_block_size];
  packPose(T_i, blocks[0]);
  packPose(T_j, blocks[1]);
  const double* pointers[2] = {blocks[0], blocks[1]};
  Vector6 whitened;
  makeEdgeCost(ErrorCoordinates::quaternion, edge)->Evaluate(pointers, whitened.data(), nullptr);
  const Vector6 error = edgeError(ErrorCoordinates::quaternion, edge.T_from_to, T_i, T_j);
  EXPECT_NEAR(whitened.squaredNorm() / error.dot(edge.information * error), 1, 1e-9);
}

TEST(EdgeCost, PlanarErrorIsTheSpatialOneInThePlane)
{
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> u(-3, 3);
  for (int trial = 0; trial < 10; ++trial)
  {
    GraphEdge edge;
    edge.T_from_to = poseFromYpr(u(rng), u(rng), 0, u(rng), 0, 0);
    const double i[3] = {u(rng), u(rng), u(rng)};
    const double j[3] = {u(rng), u(rng), u(rng)};
    const double* pointers[2] = {i, j};
    Eigen::Vector3d planar;
    makePlanarEdgeCost(edge)->Evaluate(pointers, planar.data(), nullptr);
    const Vector6 spatial =
        edgeError(ErrorCoordinates::split_log, edge.T_from_to,
                  poseFromYpr(i[0], i[1], 0, i[2], 0, 0), poseFromYpr(j[0], j[1], 0, j[2], 0, 0));
    EXPECT_LT((planar - Eigen::Vector3d(spatial[0], spatial[1], spatial[5])).norm(), 1e-9);
  }
}

TEST(PoseManifold, PlusAndMinusAreInverse)
{
  std::mt19937 rng(7);
  const PoseManifold manifold;
  double x[pose_block_size];
  double y[pose_block_size];
  packPose(randomPose(rng, 10, 2), x);
  const Vector6 delta = logSE3(randomPose(rng, 1, 1));
  manifold.Plus(x, delta.data(), y);
  Vector6 back;
  manifold.Minus(y, x, back.data());
  EXPECT_LT((back - delta).norm(), 1e-12);
}

TEST(DcsLoss, DerivativesMatchAndItLevelsOut)
{
  const auto loss = makeDcsLoss(3);
  for (const double s : {0.5, 8.9, 9.1, 20.0, 1e4})
  {
    double rho[3];
    double plus[3];
    double minus[3];
    const double h = 1e-4 * s;
    loss->Evaluate(s, rho);
    loss->Evaluate(s + h, plus);
    loss->Evaluate(s - h, minus);
    EXPECT_NEAR(rho[1], (plus[0] - minus[0]) / (2 * h), 1e-6) << s;
    if (s > 9.05 || s < 8.95)
    {
      EXPECT_NEAR(rho[2], (plus[1] - minus[1]) / (2 * h), 1e-5) << s;
    }
    EXPECT_LE(rho[0], s + 1e-12);
    EXPECT_LT(rho[0], 27);
  }
}
}  // namespace
}  // namespace dyslam
