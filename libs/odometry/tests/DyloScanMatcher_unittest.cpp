// SPDX-License-Identifier: BSD-3-Clause
// DyLO with the shipped weights, on scenes of exact geometry.
#include <dyslam/base/Error.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <fstream>

#include "TestScene.h"

namespace dyslam
{
namespace
{

ScanMatch matchFrom(ScanMatcher& matcher,
                    const Frame& frame,
                    const Pose& guess,
                    const Matrix6& information = Matrix6::Zero())
{
  MotionPrior prior;
  prior.T_previous_current = guess;
  prior.information = information;
  return matcher.match(frame, prior);
}

class Dylo : public testing::Test
{
 protected:
  test::StreetScene scene_;
  ThreadPool pool_{1};

  [[nodiscard]] std::unique_ptr<ScanMatcher> make(const std::vector<std::string>& settings = {})
  {
    Config config;
    for (const std::string& setting : settings)
    {
      config.set(setting);
    }
    ConfigLoader loader(config);
    return makeScanMatcher("dylo", loader, pool_);
  }

  MotionEstimate move(const Pose& T, const Pose& prediction = Pose::Identity(), int keep_ring = 1)
  {
    const auto matcher = make();
    (void)matchFrom(*matcher, thinned(scene_.frame(Pose::Identity(), 0.01, 1), keep_ring),
                    Pose::Identity());
    return matchFrom(*matcher, thinned(scene_.frame(T, 0.01, 2), keep_ring), prediction).motion;
  }

  /** Every `keep`th beam of the scene's 32. */
  static Frame thinned(Frame frame, int keep)
  {
    if (keep == 1)
    {
      return frame;
    }
    Cloud cloud;
    const Pose T_lidar_vehicle = frame.scan.T_vehicle_lidar.inverse();
    for (std::size_t i = 0; i < frame.cloud.size(); ++i)
    {
      const Eigen::Vector3d p = T_lidar_vehicle * frame.cloud.points[i].cast<double>();
      const double elevation = std::atan2(p.z(), std::hypot(p.x(), p.y())) / test::degree;
      if (std::lround(elevation + 24) % keep == 0)
      {
        cloud.points.push_back(frame.cloud.points[i]);
      }
    }
    frame.cloud = cloud;
    return frame;
  }

  static void expectNear(const MotionEstimate& estimate, const Pose& T, double meters, double deg)
  {
    EXPECT_TRUE(estimate.converged()) << estimate.reason;
    const Pose error = T.inverse() * estimate.T_previous_current;
    EXPECT_LT(error.translation().norm(), meters);
    EXPECT_LT(rotationAngle(error) / test::degree, deg);
  }
};

TEST_F(Dylo, StandsStill)
{
  expectNear(move(Pose::Identity()), Pose::Identity(), 0.02, 0.1);
}

TEST_F(Dylo, TurnsOnTheSpot)
{
  const Pose T = poseFromYpr(0, 0, 0, 3 * test::degree, 0, 0);
  expectNear(move(T), T, 0.05, 0.2);
}

TEST_F(Dylo, FindsASkippedFramesMotion)
{
  const Pose T = poseFromYpr(1.6, 0.02, 0, 1 * test::degree, 0, 0);
  // The prediction still is the motion of one step.
  expectNear(move(T, poseFromYpr(0.8, 0.01, 0, 0.5 * test::degree, 0, 0)), T, 0.06, 0.2);
}

/** With zero motion as initial guess a large motion is out of range. */
TEST_F(Dylo, StartsFromThePrediction)
{
  const Pose prediction = poseFromYpr(2.5, 0, 0, 0, 0, 0);
  const auto with = [&](const std::vector<std::string>& settings)
  {
    const auto matcher = make(settings);
    (void)matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    return matchFrom(*matcher, scene_.frame(prediction, 0.01, 2), prediction)
        .motion.T_previous_current;
  };
  const Pose found = with({});
  EXPECT_LT((found.translation() - prediction.translation()).norm(), 0.06);
  EXPECT_NE(found.matrix(), with({"dylo.start=standing"}).matrix());
}

/** Informative points outweigh an uncertain prior, but not a certain one.
 */
TEST_F(Dylo, WeighsThePredictionByItsInformation)
{
  const Pose T = poseFromYpr(0.6, 0, 0, 1 * test::degree, 0, 0);
  const Pose prediction = T * poseFromYpr(0.2, 0, 0, 0, 0, 0);
  const auto off = [&](double information, const std::vector<std::string>& settings)
  {
    const auto matcher = make(settings);
    EXPECT_EQ(matcher->usesPrior(), settings.empty());
    (void)matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    const MotionEstimate found =
        matchFrom(*matcher, scene_.frame(T, 0.01, 2), prediction, information * Matrix6::Identity())
            .motion;
    EXPECT_TRUE(found.converged()) << found.reason;
    return (T.inverse() * found.T_previous_current).translation().x();
  };
  EXPECT_NEAR(off(0, {}), 0, 0.05);
  EXPECT_NEAR(off(1, {}), 0, 0.05);
  EXPECT_NEAR(off(1e8, {}), 0.2, 0.01);
  EXPECT_NEAR(off(1e8, {"dylo.prior=false"}), 0, 0.05);
}

/** Scan of a moving sensor, deskewed by a motion that may be wrong. */
void bend(const Pose& T_own, const Pose& T_sweep, Frame& frame)
{
  const Pose T_lidar_vehicle = frame.scan.T_vehicle_lidar.inverse();
  const SweepMotion own(T_own, 0);
  const SweepMotion given(T_sweep, 0);
  frame.cloud.T_sweep = T_sweep;
  frame.cloud.phase.clear();
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    const float phase = sweepFraction(T_lidar_vehicle.cast<float>() * p, SweepModel()) - 0.5F;
    p = given.toReference(own.toReference(p, -phase), phase);
    frame.cloud.phase.push_back(phase);
  }
}

/** The motions of the first and second scan are unknown, that of the third is wrong. */
TEST_F(Dylo, DeskewsByTheMotionItFinds)
{
  const Pose T = poseFromYpr(0.7, 0, 0, 2 * test::degree, 0, 0);
  const Pose predicted = T * poseFromYpr(0.15, 0, 0, -0.5 * test::degree, 0, 0);
  const auto errors = [&](const std::vector<std::string>& settings)
  {
    const auto matcher = make(settings);
    std::vector<double> sizes;
    for (int i = 0; i < 3; ++i)
    {
      const Pose at = i == 0 ? Pose::Identity() : i == 1 ? T : T * T;
      const Pose prediction = i < 2 ? Pose::Identity() : predicted;
      Frame frame = scene_.frame(at, 0.01, static_cast<unsigned>(i + 1));
      bend(T, prediction, frame);
      const MotionEstimate found = matchFrom(*matcher, frame, prediction).motion;
      EXPECT_TRUE(found.converged()) << found.reason;
      sizes.push_back(motionSize(logSE3(T.inverse() * found.T_previous_current)));
    }
    return sizes;
  };
  const std::vector<double> deskewed = errors({});
  const std::vector<double> bent = errors({"dylo.deskew=false"});
  for (const std::size_t i : {1U, 2U})
  {
    EXPECT_LT(deskewed[i], 0.05);
    EXPECT_LT(deskewed[i], 0.5 * bent[i]);
  }
}

/** Of a recording with every second or third scan: the first sweep is a part of the interval to the
 * second scan, which shows its motion. */
TEST_F(Dylo, DeskewsAFirstScanThatIsShorterThanTheInterval)
{
  const Preprocessor preprocessor(PreprocessOptions(), pool_);
  const Pose T_sweep = poseFromYpr(0.4, 0, 0, 0.6 * test::degree, 0, 0);
  Pose T = T_sweep;
  for (const double interval : {0.1, 0.2, 0.3})
  {
    const auto matcher = make();
    const auto found = [&](const Pose& at, unsigned seed, double dt)
    {
      Frame frame;
      frame.scan = scene_.scan(at, 0.01, seed, T_sweep);
      frame.cloud = preprocessor.prepare(frame.scan, Pose::Identity(), dt);
      return matchFrom(*matcher, frame, Pose::Identity()).motion;
    };
    (void)found(Pose::Identity(), 1, 0);
    SCOPED_TRACE(interval);
    expectNear(found(T, 2, interval), T, 0.01, 0.1);
    T = T * T_sweep;
  }
}

TEST_F(Dylo, SixteenBeamsWithTheSameWeights)
{
  const Pose T = poseFromYpr(0.6, 0.05, 0, 1.5 * test::degree, 0, 0);
  expectNear(move(T, Pose::Identity(), 2), T, 0.06, 0.3);
}

TEST_F(Dylo, EmptyScanFallsBackToThePredictionAndTheChainHolds)
{
  const auto matcher = make();
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  (void)matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame empty;
  const ScanMatch match = matchFrom(*matcher, empty, step);
  const MotionEstimate& lost = match.motion;
  EXPECT_FALSE(lost.converged());
  EXPECT_FALSE(lost.reason.empty());
  EXPECT_TRUE(lost.T_previous_current.isApprox(step));
  EXPECT_TRUE(match.static_confidence.empty());
  // The next motion is relative to the pose of the empty frame.
  const Pose T = poseFromYpr(1.0, 0, 0, 0, 0, 0);
  expectNear(matchFrom(*matcher, scene_.frame(T, 0.01, 2), step).motion, step, 0.05, 0.2);
}

TEST_F(Dylo, AScanOfAnotherPlaceIsRejected)
{
  // A wall of points close by has nothing in common with the street.
  Frame other = scene_.frame(Pose::Identity(), 0.01, 1);
  for (Eigen::Vector3f& p : other.cloud.points)
  {
    const float reach = 3 + 20 * std::abs(std::sin(7 * p.x()) * std::cos(5 * p.y()));
    p *= reach / std::max(p.norm(), 1.F);
  }
  const auto matcher = make();
  (void)matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Pose prediction = poseFromYpr(0.4, 0, 0, 0, 0, 0);
  const MotionEstimate lost = matchFrom(*matcher, other, prediction).motion;
  EXPECT_FALSE(lost.converged());
  EXPECT_TRUE(lost.T_previous_current.isApprox(prediction));
}

TEST_F(Dylo, ConfidencePerPointAndInformation)
{
  const auto matcher = make();
  (void)matchFrom(*matcher, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Frame frame = scene_.frame(poseFromYpr(0.6, 0, 0, 0, 0, 0), 0.01, 2);
  const ScanMatch match = matchFrom(*matcher, frame, Pose::Identity());
  const MotionEstimate& estimate = match.motion;
  const std::vector<float>& confidence = match.static_confidence;
  ASSERT_EQ(confidence.size(), frame.cloud.size());
  for (const float c : confidence)
  {
    ASSERT_GE(c, 0.F);
    ASSERT_LE(c, 1.F);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(estimate.information);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
  const auto without = make({"dylo.confidence=false"});
  (void)matchFrom(*without, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  EXPECT_TRUE(matchFrom(*without, frame, Pose::Identity()).static_confidence.empty());
}

/** An oncoming vehicle: mean static confidence of its points, and of all others. */
TEST_F(Dylo, ConfidenceTellsWhatMoves)
{
  const Pose T = poseFromYpr(0.6, 0, 0, 1 * test::degree, 0, 0);
  const Eigen::Vector3d size(4.4, 1.8, 1.5);
  const auto at = [&](const Eigen::Vector3d& low)
  {
    test::StreetScene scene;
    scene.add(low, low + size);
    return scene;
  };
  const Eigen::Vector3d low(8, -4.6, 0.2);
  // Scans taken at rest, and skewed ones, which are encoded again.
  for (const bool underway : {false, true})
  {
    const auto matcher = make();
    Frame first = at(low + Eigen::Vector3d(1.2, 0, 0)).frame(Pose::Identity(), 0.01, 1);
    Frame second = at(low).frame(T, 0.01, 2);
    std::vector<bool> on_vehicle;
    for (const Eigen::Vector3f& p : second.cloud.points)
    {
      const Eigen::Vector3d q = (T * p.cast<double>() - low).array() + 0.1;
      on_vehicle.push_back(q.minCoeff() > 0 &&
                           (size + Eigen::Vector3d::Constant(0.2) - q).minCoeff() > 0);
    }
    if (underway)
    {
      bend(T, Pose::Identity(), first);
      bend(T, Pose::Identity(), second);
    }
    (void)matchFrom(*matcher, first, Pose::Identity());
    const ScanMatch match = matchFrom(*matcher, second, Pose::Identity());
    expectNear(match.motion, T, 0.05, 0.2);
    const std::vector<float>& confidence = match.static_confidence;
    ASSERT_EQ(confidence.size(), on_vehicle.size());
    double sum[2] = {0, 0};
    int count[2] = {0, 0};
    for (std::size_t i = 0; i < confidence.size(); ++i)
    {
      sum[on_vehicle[i] ? 1 : 0] += static_cast<double>(confidence[i]);
      ++count[on_vehicle[i] ? 1 : 0];
    }
    ASSERT_GT(count[1], 200);
    const double others = sum[0] / count[0];
    const double vehicle = sum[1] / count[1];
    EXPECT_GT(others, 0.6);
    EXPECT_LT(vehicle, 0.2);
  }
}

/** The network's images are of one lidar. */
TEST_F(Dylo, ThePointsOfAFurtherLidarChangeNothing)
{
  const Frame first = scene_.frame(Pose::Identity(), 0.01, 1);
  const Frame second = scene_.frame(poseFromYpr(0.6, 0.05, 0, 1.5 * test::degree, 0, 0), 0.01, 2);
  const auto matcher = make();
  (void)matchFrom(*matcher, first, Pose::Identity());
  const ScanMatch alone = matchFrom(*matcher, second, Pose::Identity());
  const auto of_both = make();
  (void)matchFrom(*of_both, test::withFurtherLidar(first), Pose::Identity());
  const ScanMatch both = matchFrom(*of_both, test::withFurtherLidar(second), Pose::Identity());
  ASSERT_TRUE(alone.motion.converged()) << alone.motion.reason;
  const Pose difference =
      alone.motion.T_previous_current.inverse() * both.motion.T_previous_current;
  EXPECT_LT(motionSize(logSE3(difference)), 1e-6);
  ASSERT_EQ(alone.static_confidence.size(), second.cloud.size());
  ASSERT_GT(both.static_confidence.size(), second.cloud.size());
  for (std::size_t i = 0; i < second.cloud.size(); ++i)
  {
    ASSERT_NEAR(both.static_confidence[i], alone.static_confidence[i], 1e-5F) << i;
  }
}

TEST_F(Dylo, SaysWhichWeightsFileIsMissingOrNone)
{
  const auto messageOf = [&](const std::string& weights)
  {
    try
    {
      (void)make({"dylo.weights=" + weights});
    }
    catch (const UserError& error)
    {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(messageOf("/no/such/file.safetensors").find("/no/such/file.safetensors"),
            std::string::npos);
  const std::string other = testing::TempDir() + "no_weights.safetensors";
  std::ofstream(other) << "not a model";
  const std::string message = messageOf(other);
  EXPECT_EQ(0U, message.rfind("dylo.weights: " + other + ": is no file of weights", 0)) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  // The weights of another network.
  EXPECT_NE(messageOf("dyseg.safetensors").find("is not a DyLO model"), std::string::npos);
}
}  // namespace
}  // namespace dyslam
