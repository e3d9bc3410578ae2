// SPDX-License-Identifier: BSD-3-Clause
// DyLO with the weights that come with DySLAM, on scenes of exact geometry.
#include <dyslam/core/Deskew.h>
#include <dyslam/core/Error.h>
#include <dyslam/odometry/LidarOdometry.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <fstream>

#include "TestScene.h"

namespace dyslam
{
namespace
{
constexpr double degree = 3.14159265358979323846 / 180;

class Dylo : public testing::Test
{
 protected:
  test::StreetScene scene_;
  ThreadPool pool_{1};

  [[nodiscard]] std::unique_ptr<LidarOdometry> make(const std::vector<std::string>& settings = {})
  {
    Config config;
    for (const std::string& setting : settings)
    {
      config.set(setting);
    }
    ConfigLoader loader(config);
    return makeOdometry("dylo", loader, pool_);
  }

  MotionEstimate move(const Pose& T, const Pose& prediction = Pose::Identity(), int keep_ring = 1)
  {
    const auto odometry = make();
    (void)odometry->process(thinned(scene_.frame(Pose::Identity(), 0.01, 1), keep_ring),
                            Pose::Identity());
    return odometry->process(thinned(scene_.frame(T, 0.01, 2), keep_ring), prediction);
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
      const double elevation = std::atan2(p.z(), std::hypot(p.x(), p.y())) / degree;
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
    EXPECT_TRUE(estimate.converged) << estimate.reason;
    const Pose error = T.inverse() * estimate.T_previous_current;
    EXPECT_LT(error.translation().norm(), meters);
    EXPECT_LT(rotationAngle(error) / degree, deg);
  }
};

TEST_F(Dylo, StandsStill)
{
  expectNear(move(Pose::Identity()), Pose::Identity(), 0.02, 0.1);
}

TEST_F(Dylo, TurnsOnTheSpot)
{
  const Pose T = poseFromYpr(0, 0, 0, 3 * degree, 0, 0);
  expectNear(move(T), T, 0.05, 0.2);
}

TEST_F(Dylo, FindsASkippedFramesMotion)
{
  const Pose T = poseFromYpr(1.6, 0.02, 0, 1 * degree, 0, 0);
  // The prediction still is the motion of one step.
  expectNear(move(T, poseFromYpr(0.8, 0.01, 0, 0.5 * degree, 0, 0)), T, 0.06, 0.2);
}

/** From standing a far motion is out of reach. */
TEST_F(Dylo, StartsFromThePrediction)
{
  const Pose prediction = poseFromYpr(2.5, 0, 0, 0, 0, 0);
  const auto with = [&](const std::vector<std::string>& settings)
  {
    const auto odometry = make(settings);
    (void)odometry->process(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    return odometry->process(scene_.frame(prediction, 0.01, 2), prediction).T_previous_current;
  };
  const Pose found = with({});
  EXPECT_LT((found.translation() - prediction.translation()).norm(), 0.06);
  EXPECT_NE(found.matrix(), with({"dylo.start=standing"}).matrix());
}

/** Points that show the motion well overrule a prediction that is not sure of itself, and only it.
 */
TEST_F(Dylo, WeighsThePredictionByItsInformation)
{
  const Pose T = poseFromYpr(0.6, 0, 0, 1 * degree, 0, 0);
  const Pose prediction = T * poseFromYpr(0.2, 0, 0, 0, 0, 0);
  const auto off = [&](double information, const std::vector<std::string>& settings)
  {
    const auto odometry = make(settings);
    EXPECT_EQ(odometry->joinsPrediction(), settings.empty());
    (void)odometry->process(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    const MotionEstimate found =
        odometry->process(scene_.frame(T, 0.01, 2), prediction, information * Matrix6::Identity());
    EXPECT_TRUE(found.converged) << found.reason;
    return (T.inverse() * found.T_previous_current).translation().x();
  };
  EXPECT_NEAR(off(0, {}), 0, 0.05);
  EXPECT_NEAR(off(1, {}), 0, 0.05);
  EXPECT_NEAR(off(1e8, {}), 0.2, 0.01);
  EXPECT_NEAR(off(1e8, {"dylo.prior=false"}), 0, 0.05);
}

/** What a sensor under way measures, deskewed by a motion that may not be its own. */
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

/** The first scan's motion is not known, the second one's neither, the third one's wrongly. */
TEST_F(Dylo, DeskewsByTheMotionItFinds)
{
  const Pose T = poseFromYpr(0.7, 0, 0, 2 * degree, 0, 0);
  const Pose predicted = T * poseFromYpr(0.15, 0, 0, -0.5 * degree, 0, 0);
  const auto errors = [&](const std::vector<std::string>& settings)
  {
    const auto odometry = make(settings);
    std::vector<double> sizes;
    for (int i = 0; i < 3; ++i)
    {
      const Pose at = i == 0 ? Pose::Identity() : i == 1 ? T : T * T;
      const Pose prediction = i < 2 ? Pose::Identity() : predicted;
      Frame frame = scene_.frame(at, 0.01, static_cast<unsigned>(i + 1));
      bend(T, prediction, frame);
      const MotionEstimate found = odometry->process(frame, prediction);
      EXPECT_TRUE(found.converged) << found.reason;
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

TEST_F(Dylo, SixteenBeamsWithTheSameWeights)
{
  const Pose T = poseFromYpr(0.6, 0.05, 0, 1.5 * degree, 0, 0);
  expectNear(move(T, Pose::Identity(), 2), T, 0.06, 0.3);
}

TEST_F(Dylo, EmptyScanFallsBackToThePredictionAndTheChainHolds)
{
  const auto odometry = make();
  const Pose step = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  (void)odometry->process(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame empty;
  const MotionEstimate lost = odometry->process(empty, step);
  EXPECT_FALSE(lost.converged);
  EXPECT_FALSE(lost.reason.empty());
  EXPECT_TRUE(lost.T_previous_current.isApprox(step));
  EXPECT_TRUE(odometry->staticConfidence().empty());
  // The next motion is told from the empty frame's place.
  const Pose T = poseFromYpr(1.0, 0, 0, 0, 0, 0);
  expectNear(odometry->process(scene_.frame(T, 0.01, 2), step), step, 0.05, 0.2);
}

TEST_F(Dylo, AScanOfAnotherPlaceIsNotBelieved)
{
  // A wall of points close by has nothing in common with the street.
  Frame other = scene_.frame(Pose::Identity(), 0.01, 1);
  for (Eigen::Vector3f& p : other.cloud.points)
  {
    const float reach = 3 + 20 * std::abs(std::sin(7 * p.x()) * std::cos(5 * p.y()));
    p *= reach / std::max(p.norm(), 1.F);
  }
  const auto odometry = make();
  (void)odometry->process(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Pose prediction = poseFromYpr(0.4, 0, 0, 0, 0, 0);
  const MotionEstimate lost = odometry->process(other, prediction);
  EXPECT_FALSE(lost.converged);
  EXPECT_TRUE(lost.T_previous_current.isApprox(prediction));
}

TEST_F(Dylo, ConfidencePerPointAndInformation)
{
  const auto odometry = make();
  (void)odometry->process(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Frame frame = scene_.frame(poseFromYpr(0.6, 0, 0, 0, 0, 0), 0.01, 2);
  const MotionEstimate estimate = odometry->process(frame, Pose::Identity());
  const std::vector<float>& confidence = odometry->staticConfidence();
  ASSERT_EQ(confidence.size(), frame.cloud.size());
  for (const float c : confidence)
  {
    ASSERT_GE(c, 0.F);
    ASSERT_LE(c, 1.F);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(estimate.information);
  EXPECT_GT(eigen.eigenvalues().minCoeff(), 0);
  EXPECT_TRUE(make({"dylo.confidence=false"})->staticConfidence().empty());
}

/** A vehicle comes along the other lane; how surely the points on it stand, and all others do. */
TEST_F(Dylo, ConfidenceTellsWhatMoves)
{
  const Pose T = poseFromYpr(0.6, 0, 0, 1 * degree, 0, 0);
  const Eigen::Vector3d size(4.4, 1.8, 1.5);
  const auto at = [&](const Eigen::Vector3d& low)
  {
    test::StreetScene scene;
    scene.add(low, low + size);
    return scene;
  };
  const Eigen::Vector3d low(8, -4.6, 0.2);
  // Scans that were taken at rest, and bent ones, which are laid out anew.
  for (const bool underway : {false, true})
  {
    const auto odometry = make();
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
    (void)odometry->process(first, Pose::Identity());
    expectNear(odometry->process(second, Pose::Identity()), T, 0.05, 0.2);
    const std::vector<float>& confidence = odometry->staticConfidence();
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
  EXPECT_NE(messageOf("/no/such/file.pt").find("/no/such/file.pt"), std::string::npos);
  const std::string other = testing::TempDir() + "no_weights.pt";
  std::ofstream(other) << "not a model";
  const std::string message = messageOf(other);
  EXPECT_NE(message.find("no DyLO model"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  // The weights of another network.
  EXPECT_NE(messageOf("dyseg.pt").find("no DyLO model"), std::string::npos);
}
}  // namespace
}  // namespace dyslam
