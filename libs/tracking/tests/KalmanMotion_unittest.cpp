// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/KalmanMotion.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>

#include "../src/NoiseScale.h"

using namespace dyslam;
using Eigen::Matrix2d;
using Eigen::Vector2d;

/** For a constant velocity without walk the filter is the least-squares line. */
TEST(KalmanMotion, EqualsTheLeastSquaresLine)
{
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, 0.1);
  KalmanMotion filter({1000, 1e-4});
  const int n = 12;
  double mean_time = 0;
  Vector2d mean = Vector2d::Zero();
  std::vector<TimedPosition> observations;
  for (int i = 0; i < n; ++i)
  {
    const double t = 0.1 * i + (i % 3 == 1 ? 0.02 : 0);
    observations.push_back({t, Vector2d(3 + 2 * t + noise(generator), -t + noise(generator))});
    ASSERT_TRUE(filter.add(observations.back(), 0.01 * Matrix2d::Identity()));
    mean_time += t / n;
    mean += observations.back().position / n;
  }
  double spread = 0;
  Vector2d slope = Vector2d::Zero();
  for (const TimedPosition& o : observations)
  {
    spread += (o.stamp - mean_time) * (o.stamp - mean_time);
    slope += (o.stamp - mean_time) * (o.position - mean);
  }
  slope /= spread;
  const MotionPrediction p = filter.predict(1.5);
  ASSERT_TRUE(p.valid);
  EXPECT_NEAR((p.velocity - slope).norm(), 0, 1e-3);
  EXPECT_NEAR((p.position - (mean + (1.5 - mean_time) * slope)).norm(), 0, 1e-3);
  const double variance = 0.01 * (1.0 / n + (1.5 - mean_time) * (1.5 - mean_time) / spread + 1);
  EXPECT_NEAR(p.covariance(0, 0), variance, 1e-4);
  EXPECT_NEAR(p.velocity_covariance(1, 1), 0.01 / spread, 1e-4);
}

/** Innovations of a manoeuvring object are as large as the filter expects. */
TEST(KalmanMotion, InnovationsAreConsistent)
{
  std::mt19937 generator(8);
  std::normal_distribution<double> normal;
  double sum = 0;
  int count = 0;
  for (int run = 0; run < 50; ++run)
  {
    KalmanMotion filter({5, 2});
    Vector2d position(10, -3);
    Vector2d velocity(5 * normal(generator), 5 * normal(generator));
    for (int i = 0; i < 40; ++i)
    {
      const TimedPosition o{0.1 * i,
                            position + 0.2 * Vector2d(normal(generator), normal(generator))};
      if (i > 0)
      {
        const MotionPrediction p = filter.predict(o.stamp);
        const Vector2d innovation = o.position - p.position;
        sum += innovation.dot(p.covariance.inverse() * innovation);
        ++count;
      }
      ASSERT_TRUE(filter.add(o, 0.04 * Matrix2d::Identity()));
      velocity += 2 * std::sqrt(0.1) * Vector2d(normal(generator), normal(generator));
      position += 0.1 * velocity;
    }
  }
  EXPECT_NEAR(sum / count, 2, 0.15);
}

TEST(KalmanMotion, RejectsWhatItCannotUse)
{
  EXPECT_THROW(KalmanMotion({0, 1}), std::invalid_argument);
  KalmanMotion filter;
  EXPECT_FALSE(filter.predict(1).valid);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(filter.add({0, Vector2d(nan, 0)}, Matrix2d::Identity()));
  EXPECT_TRUE(filter.add({0, Vector2d(1, 2)}, Matrix2d::Identity()));
  EXPECT_FALSE(filter.add({0, Vector2d(1, 2)}, Matrix2d::Identity()));
  EXPECT_FALSE(filter.add({1, Vector2d(1, 2)}, nan * Matrix2d::Identity()));
  filter.shift({5, -1});
  EXPECT_NEAR((filter.predict(0).position - Vector2d(6, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((filter.history().back().position - Vector2d(6, 1)).norm(), 0, 1e-12);
}

TEST(NoiseScale, FindsWhiteNoiseUnderSmoothMotion)
{
  std::mt19937 generator(21);
  std::normal_distribution<double> normal;
  Matrix2d covariance;
  covariance << 0.04, 0.01, 0.01, 0.02;
  const Matrix2d root = covariance.llt().matrixL();
  NoiseScale scale;
  EXPECT_EQ(scale.factor(), 1);
  PositionHistory history;
  for (int i = 0; i < 4000; ++i)
  {
    const double t = 0.1 * i;
    history.push_back({t, Vector2d(8 * t + std::sin(t), 3 * std::cos(0.5 * t)) +
                              3 * root * Vector2d(normal(generator), normal(generator))});
    if (const auto noise = whiteNoise(history, covariance))
    {
      scale.add(*noise);
    }
    if (history.size() > 6)
    {
      history.pop_front();
    }
  }
  EXPECT_NEAR(scale.factor(), 3, 0.3);
}

TEST(NoiseScale, NeedsFourEquallySpacedObservations)
{
  const Matrix2d covariance = Matrix2d::Identity();
  PositionHistory history{{0, Vector2d::Zero()}, {0.1, Vector2d::Zero()}, {0.2, Vector2d::Zero()}};
  EXPECT_FALSE(whiteNoise(history, covariance));
  history.push_back({0.3, Vector2d(20, 0)});
  ASSERT_TRUE(whiteNoise(history, covariance));
  EXPECT_NEAR(*whiteNoise(history, covariance), 20 / std::sqrt(20) / std::sqrt(M_PI / 2), 1e-12);
  history.back().stamp = 0.4;
  EXPECT_FALSE(whiteNoise(history, covariance));
}
