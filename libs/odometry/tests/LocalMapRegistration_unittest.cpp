// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "RegistrationTest.h"

namespace dyslam
{
namespace
{
using test::drive;
using test::step;

class Registration : public test::RegistrationTest
{
};

/** Preprocessing and registration with a constant-velocity initial guess. */
std::vector<RegistrationResult> run(const test::StreetScene& scene,
                                    const std::vector<Pose>& poses,
                                    const RefineOptions& options,
                                    ThreadPool& pool)
{
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  LocalMapRegistration registration(options, pool);
  std::vector<RegistrationResult> results;
  Pose motion = Pose::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const Pose T_sweep = poses.size() < 2 ? Pose::Identity()
                         : i == 0         ? Pose(poses[0].inverse() * poses[1])
                                          : Pose(poses[i - 1].inverse() * poses[i]);
    Frame frame;
    frame.scan = scene.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), T_sweep);
    frame.cloud = preprocessor.prepare(frame.scan, motion, 0.1);
    results.push_back(step(registration, frame, registration.pose() * motion));
    motion = results.back().motion.T_previous_current;
  }
  return results;
}

TEST_P(Registration, FollowsADriveFromAStartInMotion)
{
  const std::vector<Pose> poses = drive(10);
  const std::vector<RegistrationResult> results = run(scene_, poses, options(), pool_);
  for (std::size_t i = 1; i < poses.size(); ++i)
  {
    EXPECT_TRUE(results[i].motion.converged()) << i << ": " << results[i].motion.reason;
    EXPECT_FALSE(results[i].degenerate);
    const Pose error = poses[i].inverse() * results[i].T_odom_vehicle;
    EXPECT_LT(error.translation().norm(), 0.05) << i;
    EXPECT_LT(rotationAngle(error), 0.2 * test::degree) << i;
  }
}

TEST_P(Registration, AKnownInitialSigmaReplacesTheOptions)
{
  LocalMapRegistration registration(options(), pool_);
  (void)step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  EXPECT_EQ(registration.framesInMap(), 1);
  const Pose T = poseFromYpr(0.02, 0, 0, 0, 0, 0);
  const Frame frame = scene_.frame(T, 0.01, 2);
  const double by_option = registration.align(frame, Pose::Identity()).result().loss_width;
  EXPECT_EQ(by_option, options().max_loss_width) << "2 m";
  LocalMapRegistration known(options(), pool_);
  (void)step(known, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const RegistrationResult found = step(known, frame, Pose::Identity(), 0.1);
  EXPECT_EQ(found.loss_width, 0.1);
  EXPECT_LT((T.inverse() * found.T_odom_vehicle).translation().norm(), 0.03);
  EXPECT_EQ(known.framesInMap(), 2);
}

/** Points that are labelled moving after the pose is known are not added to the map. */
TEST_P(Registration, AddsPointsWithTheWeightsOfThatMoment)
{
  LocalMapRegistration registration(options(), pool_);
  Frame frame = scene_.frame(Pose::Identity(), 0.01, 1);
  LocalMapRegistration::Alignment alignment = registration.align(frame, Pose::Identity());
  EXPECT_TRUE(registration.mapPoints().empty()) << "not yet added";
  for (const Eigen::Vector3f& p : frame.cloud.points)
  {
    frame.moving_probability.push_back(p.y() > 3 && p.z() > 0.3F ? 1.0F : 0.0F);
  }
  registration.commit(std::move(alignment), frame);
  EXPECT_FALSE(registration.mapPoints().empty());
  for (const Eigen::Vector3f& p : registration.mapPoints())
  {
    EXPECT_FALSE(p.y() > 3.2F && p.z() > 0.5F) << p.transpose();
  }
}

TEST_P(Registration, AligningChangesNothing)
{
  const std::vector<Pose> poses = drive(4);
  const auto frameAt = [&](std::size_t i)
  { return scene_.frame(poses[i], 0.01, static_cast<unsigned>(i + 1)); };
  LocalMapRegistration tried(options(), pool_);
  LocalMapRegistration plain(options(), pool_);
  for (std::size_t i = 0; i < 3; ++i)
  {
    const Frame frame = frameAt(i);
    step(tried, frame, poses[i]);
    step(plain, frame, poses[i]);
    const Frame next = frameAt(i + 1);
    const Frame foreign = test::inTheAir(next);
    EXPECT_TRUE(tried.align(next, poses[i + 1]).result().motion.converged());
    for (int failed = 0; failed < 6; ++failed)
    {
      const MotionEstimate motion = tried.align(foreign, poses[i + 1]).result().motion;
      EXPECT_FALSE(motion.converged());
      EXPECT_FALSE(motion.map_restarted);
    }
    EXPECT_EQ(tried.framesInMap(), plain.framesInMap());
    EXPECT_EQ(tried.pose().matrix(), plain.pose().matrix());
    EXPECT_EQ(tried.mapPoints(), plain.mapPoints());
  }
  const RegistrationResult a = tried.align(frameAt(3), poses[3]).result();
  const RegistrationResult b = plain.align(frameAt(3), poses[3]).result();
  EXPECT_TRUE(a.motion.converged());
  EXPECT_EQ(a.T_odom_vehicle.matrix(), b.T_odom_vehicle.matrix());
  EXPECT_EQ(a.motion.T_previous_current.matrix(), b.motion.T_previous_current.matrix());
  EXPECT_EQ(a.motion.information, b.motion.information);
  EXPECT_EQ(a.loss_width, b.loss_width);
}

TEST_P(Registration, MotionsChainToThePoses)
{
  Pose T = Pose::Identity();
  for (const RegistrationResult& result : run(scene_, drive(5), options(), pool_))
  {
    T = T * result.motion.T_previous_current;
    EXPECT_TRUE(T.isApprox(result.T_odom_vehicle, 1e-9));
  }
}

TEST_P(Registration, SameBytesForAnyNumberOfThreads)
{
  ThreadPool one(1);
  ThreadPool three(3);
  const std::vector<RegistrationResult> a = run(scene_, drive(4), options(), one);
  const std::vector<RegistrationResult> b = run(scene_, drive(4), options(), three);
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_EQ(a[i].T_odom_vehicle.matrix(), b[i].T_odom_vehicle.matrix());
    EXPECT_EQ(a[i].motion.information, b[i].motion.information);
  }
}

TEST_P(Registration, MovingPointsCanGetNoWeight)
{
  const Pose T = poseFromYpr(0.4, 0, 0, 0.01, 0, 0);
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame frame = scene_.frame(T, 0.01, 2);
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    const bool moves = p.z() > 0.3F && (p.y() > 0 || p.x() > 25);
    p.x() += moves ? 0.3F : 0.0F;
    frame.moving_probability.push_back(moves ? 1.0F : 0.0F);
  }
  const RegistrationResult result = step(registration, frame, T);
  EXPECT_LT((T.inverse() * result.T_odom_vehicle).translation().norm(), 0.03);
  for (const Eigen::Vector3f& p : registration.mapPoints())
  {
    EXPECT_LT(p.z(), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         Registration,
                         testing::Values(RefineMethod::point_to_plane, RefineMethod::gicp),
                         test::methodName);

/** A flat ground, or a tunnel along x, as an endless regular sampling. */
Frame openScene(bool tunnel, const Pose& T)
{
  std::vector<Eigen::Vector3f> points;
  for (int i = -60; i <= 60; ++i)
  {
    for (int j = -30; j <= 30; ++j)
    {
      const double x = 0.25 * i + 0.07 * ((i * 7 + j * 3) % 5);
      const Eigen::Vector3d p =
          tunnel ? Eigen::Vector3d(x, 4 * std::cos(0.105 * j), 3 + 3 * std::sin(0.105 * j))
                 : Eigen::Vector3d(x, 0.25 * j, 0);
      points.push_back((T.inverse() * p).cast<float>());
    }
  }
  return test::frameOf(points);
}

TEST(RegistrationInOpenScenes, GuessIsKeptAlongOpenDirections)
{
  ThreadPool pool(2);
  for (const bool tunnel : {false, true})
  {
    LocalMapRegistration registration(RefineOptions(), pool);
    step(registration, openScene(tunnel, Pose::Identity()), Pose::Identity());
    Pose guess = Pose::Identity();
    RegistrationResult result;
    for (int i = 1; i <= 4; ++i)
    {
      guess.translation().x() = 0.5 * i;
      Pose T = guess;
      T.translation().z() = 0.05;
      result = step(registration, openScene(tunnel, T), guess);
    }
    EXPECT_TRUE(result.degenerate) << "tunnel " << tunnel;
    EXPECT_NEAR(result.T_odom_vehicle.translation().x(), 2, 0.1) << "tunnel " << tunnel;
    EXPECT_NEAR(result.T_odom_vehicle.translation().z(), 0.05, 0.02) << "tunnel " << tunnel;
    // A strong prior along z, a weak one along x.
    const Matrix6 covariance = result.motion.information.inverse();
    EXPECT_GT(covariance(0, 0), 30 * covariance(2, 2)) << "tunnel " << tunnel;
    EXPECT_GT(covariance(0, 0), 0.01) << "tunnel " << tunnel;
  }
}

TEST(RegistrationMap, TakesNoAlignmentOfNoFrame)
{
  ThreadPool pool(1);
  LocalMapRegistration registration(RefineOptions(), pool);
  EXPECT_THROW(registration.commit({}, Frame()), std::logic_error);
  const Frame frame = test::StreetScene().frame(Pose::Identity(), 0.01, 1);
  LocalMapRegistration::Alignment alignment = registration.align(frame, Pose::Identity());
  registration.commit(std::move(alignment), frame);
  EXPECT_EQ(registration.framesInMap(), 1);
}

/** What a lidar at x sees, with noise, of an endless corridor along x. Pillars at uneven distances
 * stand out of its walls, with faces across the way that constrain the motion along it. */
Frame corridorAt(int x)
{
  constexpr int kColumnsPerMetre = 10;
  std::mt19937 generator(static_cast<unsigned>(x));
  std::normal_distribution<float> noise(0, 0.01F);
  std::uniform_real_distribution<float> within_step(-0.5F, 0.5F);
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](float along, float across, float up)
  {
    points.push_back(Eigen::Vector3f{along + noise(generator), across + noise(generator),
                                     up + noise(generator)});
  };
  for (int k = -15 * kColumnsPerMetre; k <= 15 * kColumnsPerMetre; ++k)
  {
    const int in_period = (k + x * kColumnsPerMetre + 1700) % 170;
    const bool pillar = in_period % 40 < 8 && in_period < 160;
    const bool face = (in_period % 40 == 0 || in_period % 40 == 8) && in_period < 160;
    for (int j = 0; j < 12; ++j)
    {
      const float along = (static_cast<float>(k) + within_step(generator)) / kColumnsPerMetre;
      const float up = 0.25F * (static_cast<float>(j) + within_step(generator));
      add(along, up - 1.5F, 0);
      for (const float side : {-1.0F, 1.0F})
      {
        add(along, side * (pillar ? 2.2F : 3.0F), up);
        for (int i = 0; face && i < 8; ++i)
        {
          const float across = 2.2F + 0.1F * (static_cast<float>(i) + within_step(generator));
          add(static_cast<float>(k) / kColumnsPerMetre, side * across, up);
        }
      }
    }
  }
  return test::frameOf(points);
}

TEST(RegistrationMap, StaysBoundedOnALongDrive)
{
  ThreadPool pool(2);
  RefineOptions options;
  options.map_radius = 20;
  LocalMapRegistration registration(options, pool);
  std::size_t most_early = 0;
  std::size_t most_late = 0;
  for (int i = 0; i < 120; ++i)
  {
    Pose T = Pose::Identity();
    T.translation().x() = i;
    const RegistrationResult result = step(registration, corridorAt(i), T);
    ASSERT_NEAR(result.T_odom_vehicle.translation().x(), i, 0.3);
    std::size_t& most = i < 60 ? most_early : most_late;
    most = std::max(most, registration.mapPoints().size());
  }
  EXPECT_LT(most_late, most_early + most_early / 10);
}

TEST(RefineOptions, AreChecked)
{
  ThreadPool pool(1);
  RefineOptions options;
  options.cell_size = 0;
  EXPECT_THROW(LocalMapRegistration(options, pool), UserError);
}
}  // namespace
}  // namespace dyslam
