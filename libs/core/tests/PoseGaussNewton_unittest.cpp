// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PoseGaussNewton.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace dyslam
{
namespace
{
class Randomness
{
 public:
  explicit Randomness(unsigned seed) : engine_(seed) {}
  Eigen::Vector3d vector()
  {
    return Eigen::Vector3d(normal_(engine_), normal_(engine_), normal_(engine_));
  }

 private:
  std::mt19937 engine_;
  std::normal_distribution<double> normal_;
};

TEST(NormalEquations, GradientAgreesWithNumericDerivative)
{
  Randomness random(4);
  for (int round = 0; round < 20; ++round)
  {
    Vector6 tangent;
    tangent << random.vector(), random.vector();
    const Pose T = expSE3(tangent);
    const Eigen::Vector3d n = random.vector().normalized();
    const Eigen::Vector3d p = 5 * random.vector();
    const Eigen::Vector3d q = random.vector();
    const auto residual = [&](const Pose& at) { return n.dot(at * p - q); };
    NormalEquations sums;
    sums.addRow(n, p, T.linear(), residual(T), 1);
    for (int k = 0; k < 6; ++k)
    {
      constexpr double h = 1e-6;
      const Vector6 d = h * Vector6::Unit(k);
      const double slope = (residual(T * expSE3(d)) - residual(T * expSE3(-d))) / (2 * h);
      EXPECT_NEAR(sums.g[k], slope * residual(T), 1e-5 * (1 + std::fabs(sums.g[k])));
      EXPECT_NEAR(sums.H(k, k), slope * slope, 1e-5 * (1 + sums.H(k, k)));
    }
  }
}

TEST(GemanMcClure, WeightIsTheSlopeOfTheLoss)
{
  // loss(s) = k^2 s / (k^2 + s) of the squared residual s
  constexpr double width = 0.3;
  const auto loss = [&](double s) { return width * width * s / (width * width + s); };
  for (const double s : {0.001, 0.05, 0.4, 3.0})
  {
    const double slope = (loss(s * 1.0001) - loss(s * 0.9999)) / (0.0002 * s);
    EXPECT_NEAR(gemanMcClureWeight(s, width), slope, 1e-6);
  }
  EXPECT_EQ(gemanMcClureWeight(0, width), 1);
}

/** Points on three walls of a corner, one in ten of them moved away, and rows against the walls. */
struct Corner
{
  explicit Corner(const Pose& T_walls_points)
  {
    Randomness random(7);
    for (std::size_t i = 0; i < 3000; ++i)
    {
      Eigen::Vector3d p = 4 * random.vector();
      p[static_cast<Eigen::Index>(i % 3)] = (i % 10 == 0 ? 0.5 : 0) + 0.01 * random.vector().x();
      points.push_back(T_walls_points.inverse() * p);
    }
  }

  [[nodiscard]] RowMatcher matcher() const
  {
    return [this](std::size_t begin, std::size_t end, const Pose& T, double gate,
                  NormalEquations& sums)
    {
      for (std::size_t i = begin; i < end; ++i)
      {
        const auto axis = static_cast<Eigen::Index>(i % 3);
        const double r = (T * points[i])[axis];
        if (std::abs(r) < gate)
        {
          sums.addRow(Eigen::Vector3d::Unit(axis), points[i], T.linear(), r,
                      gemanMcClureWeight(r * r, 0.1));
          ++sums.inliers;
        }
      }
    };
  }

  std::vector<Eigen::Vector3d> points;
};

TEST(PoseGaussNewton, FindsAMotionForwardAndInverseWithTheSameBytesOnAnyThreads)
{
  const Pose motion = poseFromYpr(0.3, -0.2, 0.1, 0.05, -0.02, 0.03);
  for (const Pose& T : {motion, motion.inverse()})
  {
    const Corner corner(T);
    Pose found[2];
    for (int k = 0; k < 2; ++k)
    {
      ThreadPool pool(k == 0 ? 1 : 4);
      const auto result =
          poseGaussNewton(corner.points.size(), corner.matcher(), Pose::Identity(), {}, pool);
      EXPECT_TRUE(result.converged) << result.reason;
      EXPECT_TRUE(result.reason.empty());
      EXPECT_LT(motionSize(logSE3(T.inverse() * result.T)), 0.01);
      EXPECT_EQ(result.equations.inliers, 2700U);  // the moved tenth is beyond the last gate
      const MotionEstimate estimate = toMotionEstimate(result, 10);
      EXPECT_NEAR(estimate.rmse, 0.01, 0.001);
      // Ten correlated points count as one.
      const MotionEstimate independent = toMotionEstimate(result, 1);
      EXPECT_NEAR(independent.information(0, 0) / estimate.information(0, 0), 10, 1e-9);
      found[k] = result.T;
    }
    EXPECT_EQ(found[0].matrix(), found[1].matrix());
  }
}

TEST(PoseGaussNewton, WhatNoRowFixesStaysAsGiven)
{
  const Corner corner(Pose::Identity());
  const auto floor =
      [&](std::size_t begin, std::size_t end, const Pose& T, double, NormalEquations& sums)
  {
    for (std::size_t i = begin; i < end; ++i)
    {
      if (i % 3 == 2)
      {
        sums.addRow(Eigen::Vector3d::UnitZ(), corner.points[i], T.linear(),
                    (T * corner.points[i]).z(), 1);
        ++sums.inliers;
      }
    }
  };
  ThreadPool pool;
  const auto result = poseGaussNewton(corner.points.size(), floor,
                                      poseFromYpr(0.4, -0.3, 0.2, 0.1, 0, 0), {}, pool);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_NEAR(result.T.translation().x(), 0.4, 1e-3);
  EXPECT_NEAR(result.T.translation().y(), -0.3, 1e-3);
  EXPECT_NEAR(yawPitchRoll(result.T).x(), 0.1, 1e-3);
  EXPECT_LT(std::abs(result.T.translation().z()), 0.1);
}

TEST(PoseGaussNewton, TooFewMatchesAndNoPointsHaveAReason)
{
  const Corner corner(Pose::Identity());
  ThreadPool pool;
  const Pose far = poseFromYpr(100, 100, 100, 0, 0, 0);
  for (const std::size_t count : {std::size_t{0}, corner.points.size()})
  {
    const auto result = poseGaussNewton(count, corner.matcher(), far, {}, pool);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.reason, "only 0 matches");
    EXPECT_TRUE(toMotionEstimate(result, 1).information.isZero(0));
  }
}
}  // namespace
}  // namespace dyslam
