// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/AdaptivePredictor.h>
#include <dyslam/tracking/PolynomialTrajectory.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>

using namespace dyslam;
using Eigen::Vector2d;

namespace
{
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

PolynomialOptions optionsOf(int degree, int window)
{
  PolynomialOptions options;
  options.degree = degree;
  options.window = window;
  return options;
}

/** A cubic in both coordinates, far from the origin and at UNIX times. */
Vector2d curve(double t)
{
  const double s = t - 1.7e9;
  return {5000 + 10 * s - 0.5 * s * s + 0.1 * s * s * s, -3000 + 2 * s + 0.8 * s * s};
}

Vector2d slope(double t)
{
  const double s = t - 1.7e9;
  return {10 - s + 0.3 * s * s, 2 + 1.6 * s};
}
}  // namespace

TEST(PolynomialTrajectory, recoversACubicWithGapsAtUnixTimes)
{
  for (int degree = 3; degree <= 5; ++degree)
  {
    PolynomialTrajectory trajectory(optionsOf(degree, 30));
    double t = 1.7e9;
    for (int i = 0; i < 40; ++i)
    {
      t += i % 7 == 3 ? 0.4 : 0.1;
      ASSERT_TRUE(trajectory.add({t, curve(t)}));
    }
    const MotionPrediction p = trajectory.predict(t + 0.1);
    ASSERT_TRUE(p.valid);
    EXPECT_EQ(p.degree, degree);
    EXPECT_EQ(p.samples, 30u);
    EXPECT_LT((p.position - curve(t + 0.1)).norm(), 1e-4) << degree;
    EXPECT_LT((p.velocity - slope(t + 0.1)).norm(), 1e-3) << degree;
  }
}

TEST(PolynomialTrajectory, limitsTheDegreeForAShortHistory)
{
  PolynomialTrajectory trajectory(optionsOf(5, 30));
  EXPECT_FALSE(trajectory.predict(0).valid);
  trajectory.add({0, {1, 2}});
  EXPECT_EQ(trajectory.predict(0.1).degree, 0);
  EXPECT_LT((trajectory.predict(0.1).position - Vector2d(1, 2)).norm(), 1e-12);
  trajectory.add({0.1, {2, 2}});
  EXPECT_EQ(trajectory.predict(0.2).degree, 1);
  EXPECT_LT((trajectory.predict(0.2).position - Vector2d(3, 2)).norm(), 1e-9);
  EXPECT_LT((trajectory.predict(0.2).velocity - Vector2d(10, 0)).norm(), 1e-9);
  EXPECT_GT(trajectory.predict(0.2).covariance.trace(), 0);
}

TEST(PolynomialTrajectory, rejectsNaNAndNonIncreasingStamps)
{
  PolynomialTrajectory trajectory(optionsOf(2, 5));
  EXPECT_FALSE(trajectory.add({not_a_number, {0, 0}}));
  EXPECT_FALSE(trajectory.add({0, {not_a_number, 0}}));
  EXPECT_TRUE(trajectory.add({1, {0, 0}}));
  EXPECT_FALSE(trajectory.add({1, {0, 0}}));
  EXPECT_FALSE(trajectory.add({0.5, {0, 0}}));
  EXPECT_EQ(trajectory.size(), 1u);
  EXPECT_FALSE(trajectory.predict(not_a_number).valid);
  EXPECT_THROW(PolynomialTrajectory(optionsOf(6, 5)), std::invalid_argument);
  EXPECT_THROW(PolynomialTrajectory(optionsOf(2, 0)), std::invalid_argument);
}

TEST(PolynomialTrajectory, constantVelocityUsesTheLastTwoObservations)
{
  PolynomialOptions options;
  options.model = MotionModel::constant_velocity;
  PolynomialTrajectory trajectory(options);
  trajectory.add({0, {100, 100}});
  trajectory.add({1, {0, 0}});
  trajectory.add({2, {1, 3}});
  EXPECT_LT((trajectory.predict(3).position - Vector2d(2, 6)).norm(), 1e-9);
}

/** The covariance must be consistent with the errors (mean normalised estimation error). */
TEST(PolynomialTrajectory, covarianceIsConsistentWithTheErrors)
{
  std::mt19937 generator(3);
  std::normal_distribution<double> noise(0, 0.2);
  double sum = 0;
  double velocity_sum = 0;
  constexpr int trials = 2000;
  for (int trial = 0; trial < trials; ++trial)
  {
    PolynomialTrajectory trajectory(optionsOf(2, 20));
    for (int i = 0; i < 20; ++i)
    {
      const double t = 0.1 * i;
      trajectory.add({t, {5 * t + t * t + noise(generator), -2 * t + noise(generator)}});
    }
    const MotionPrediction p = trajectory.predict(2.0);
    const Vector2d seen(5 * 2.0 + 4 + noise(generator), -4 + noise(generator));
    const Vector2d e = p.position - seen;
    sum += e.dot(p.covariance.inverse() * e) / 2;
    const Vector2d v = p.velocity - Vector2d(9, -2);
    velocity_sum += v.dot(p.velocity_covariance.inverse() * v) / 2;
  }
  EXPECT_NEAR(sum / trials, 1.1, 0.25);  // above 1 because the noise is estimated
  EXPECT_NEAR(velocity_sum / trials, 1.1, 0.25);
}

/** The members share one factorisation; each must equal a separate fit. */
TEST(AdaptivePredictor, eachMemberEqualsASeparateFit)
{
  std::mt19937 generator(5);
  std::normal_distribution<double> noise(0, 0.1);
  for (std::size_t member = 0; member < AdaptivePredictor::bank.size(); ++member)
  {
    const auto [degree, window] = AdaptivePredictor::bank[member];
    AdaptiveOptions options;
    options.outlier_sigmas = 1e9;  // the fits alone
    AdaptivePredictor adaptive(options);
    PolynomialTrajectory alone(optionsOf(degree, window));
    double t = 0;
    for (int i = 0; i < 70; ++i)
    {
      t += i % 5 == 0 ? 0.3 : 0.1;
      const TimedPosition observation{t,
                                      {8 * t + noise(generator), std::sin(t) + noise(generator)}};
      adaptive.add(observation);
      alone.add(observation);
    }
    const auto all = adaptive.memberPredictions(t + 0.1);
    const Vector2d one = all.row(static_cast<Eigen::Index>(member)).transpose();
    EXPECT_LT((one - alone.predict(t + 0.1).position).norm(), 1e-6)
        << "degree " << degree << " window " << window;
  }
}

namespace
{
struct Scores
{
  double adaptive = 0;
  double best_fixed = std::numeric_limits<double>::infinity();
};

/** Errors on one path of the adaptive predictor and of the member that is best on all of it. */
template <typename Path>
Scores compare(Path&& path, double sigma, unsigned seed)
{
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise(0, sigma);
  AdaptivePredictor adaptive;
  std::array<double, AdaptivePredictor::members> fixed{};
  double own = 0;
  for (int i = 0; i < 400; ++i)
  {
    const double t = 0.1 * i;
    if (i >= 60)
    {
      const auto all = adaptive.memberPredictions(t);
      for (int k = 0; k < AdaptivePredictor::members; ++k)
      {
        fixed[static_cast<std::size_t>(k)] += (all.row(k).transpose() - path(t)).squaredNorm();
      }
      own += (adaptive.predict(t).position - path(t)).squaredNorm();
    }
    adaptive.add({t, path(t) + Vector2d(noise(generator), noise(generator))});
  }
  Scores scores;
  scores.adaptive = std::sqrt(own / 340);
  for (const double f : fixed)
  {
    scores.best_fixed = std::min(scores.best_fixed, std::sqrt(f / 340));
  }
  return scores;
}
}  // namespace

/** The error is near that of the member that is best on the whole path, on straight and curved
 * paths, and on paths of both. */
TEST(AdaptivePredictor, isAsAccurateAsTheBestMember)
{
  const auto straight = [](double t) { return Vector2d(10 * t, 3 * t); };
  const auto turning = [](double t) { return Vector2d(6 * std::sin(t), 6 * std::cos(t)); };
  const auto mixed = [](double t)
  {
    const double s = std::fmod(t, 20.0);
    return s < 10 ? Vector2d(8 * s, 0)
                  : Vector2d(80 + 8 * std::sin(s - 10), 8 - 8 * std::cos(s - 10));
  };
  const Scores a = compare(straight, 0.1, 1);
  EXPECT_LT(a.adaptive, 1.35 * a.best_fixed);
  const Scores b = compare(turning, 0.1, 2);
  EXPECT_LT(b.adaptive, 1.35 * b.best_fixed);
  const Scores c = compare(mixed, 0.05, 3);
  EXPECT_LT(c.adaptive, 1.1 * c.best_fixed);
}

TEST(AdaptivePredictor, handlesEmptySingleAndNaN)
{
  AdaptivePredictor predictor;
  EXPECT_FALSE(predictor.predict(0).valid);
  EXPECT_FALSE(predictor.add({not_a_number, {0, 0}}));
  EXPECT_FALSE(predictor.add({0, {0, not_a_number}}));
  EXPECT_TRUE(predictor.add({0, {1, 2}}));
  EXPECT_FALSE(predictor.add({0, {1, 2}}));
  const MotionPrediction one = predictor.predict(0.5);
  ASSERT_TRUE(one.valid);
  EXPECT_LT((one.position - Vector2d(1, 2)).norm(), 1e-12);
  EXPECT_EQ(one.velocity.norm(), 0);
  EXPECT_GT(one.covariance(0, 0), 1);  // the speed is unknown
  AdaptiveOptions wrong;
  wrong.forgetting_factor = 0;
  EXPECT_THROW(AdaptivePredictor{wrong}, std::invalid_argument);
}

/** Long-term predictions are linear, with a growing covariance. */
TEST(AdaptivePredictor, longTermPredictionIsLinear)
{
  std::mt19937 generator(9);
  std::normal_distribution<double> noise(0, 0.1);
  AdaptivePredictor predictor;
  for (int i = 0; i < 60; ++i)
  {
    predictor.add({0.1 * i, {0.1 * i * 10 + noise(generator), noise(generator)}});
  }
  double last = 0;
  for (int k = 1; k <= 30; ++k)
  {
    const MotionPrediction p = predictor.predict(5.9 + 0.1 * k);
    EXPECT_LT((p.position - Vector2d(59 + k, 0)).norm(), 0.3 + 0.1 * k);
    EXPECT_GE(p.covariance.trace(), last);
    last = p.covariance.trace();
  }
  EXPECT_NEAR(predictor.predict(6.0).velocity.x(), 10, 0.5);
  EXPECT_NEAR(predictor.weights().sum(), 1, 1e-9);
}

/** A single outlier must not disturb the prediction; a step is followed at the second observation.
 */
TEST(AdaptivePredictor, clipsOutliersAndFollowsSteps)
{
  for (const bool step : {false, true})
  {
    std::mt19937 generator(13);
    std::normal_distribution<double> noise(0, 0.05);
    AdaptivePredictor guarded;
    AdaptiveOptions open;
    open.outlier_sigmas = 1e9;
    AdaptivePredictor unguarded(open);
    double worst_guarded = 0;
    double worst_unguarded = 0;
    for (int i = 0; i < 80; ++i)
    {
      const double t = 0.1 * i;
      const Vector2d truth(8 * t, step && i >= 50 ? 2 : 0);
      if (i > 50 && i < 56)
      {
        worst_guarded = std::max(worst_guarded, (guarded.predict(t).position - truth).norm());
        worst_unguarded = std::max(worst_unguarded, (unguarded.predict(t).position - truth).norm());
      }
      const Vector2d outlier(0, !step && i == 50 ? 2 : 0);
      const Vector2d seen = truth + outlier + Vector2d(noise(generator), noise(generator));
      guarded.add({t, seen});
      unguarded.add({t, seen});
    }
    if (step)
    {
      EXPECT_LT((guarded.predict(8.0).position - Vector2d(64, 2)).norm(), 0.5);
    }
    else
    {
      EXPECT_LT(worst_guarded, 0.5 * worst_unguarded);
      EXPECT_LT(worst_guarded, 0.5);
    }
  }
}
