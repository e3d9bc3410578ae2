// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "TestScene.h"

namespace dyslam
{
namespace
{

class Registration : public testing::TestWithParam<RefineMethod>
{
 protected:
  [[nodiscard]] static RefineOptions options()
  {
    RefineOptions o;
    o.method = GetParam();
    o.sample_size = 0.5;
    return o;
  }

  test::StreetScene scene_;
  ThreadPool pool_{2};
};

/** Registers a frame and adds it to the map, as the odometry does where nothing moves. */
RegistrationResult step(LocalMapRegistration& registration,
                        const Frame& frame,
                        const Pose& guess,
                        std::optional<double> initial_sigma = {})
{
  LocalMapRegistration::Alignment alignment =
      registration.align(frame, guess, nullptr, initial_sigma);
  const RegistrationResult result = alignment.result();
  registration.commit(std::move(alignment), frame);
  return result;
}

/** The frame with its points where the map has nothing. */
Frame inTheAir(Frame frame)
{
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    p.z() += 40;
  }
  return frame;
}

/** A drive along a bend, every frame skewed by its own motion. */
std::vector<Pose> drive(int frames)
{
  std::vector<Pose> poses{Pose::Identity()};
  for (int i = 1; i < frames; ++i)
  {
    poses.push_back(poses.back() * poseFromYpr(0.8, 0.02, 0, 0.8 * test::degree, 0, 0));
  }
  return poses;
}

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
    const Frame foreign = inTheAir(next);
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

TEST_P(Registration, UselessFramesKeepTheGuessAndTheMap)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const std::size_t cells = registration.mapPoints().size();
  const Pose guess = poseFromYpr(0.3, 0, 0, 0, 0, 0);
  for (const Frame& frame : {test::frameOf({}), test::frameOf({{1, 2, 3}}),
                             test::frameOf(std::vector<Eigen::Vector3f>(500, test::nanPoint()))})
  {
    const RegistrationResult result = step(registration, frame, guess);
    EXPECT_FALSE(result.motion.registered());
    EXPECT_FALSE(result.motion.reason.empty());
    EXPECT_EQ(result.motion.cause, FailureCause::recording);
    EXPECT_TRUE(result.T_odom_vehicle.isApprox(guess));
    EXPECT_EQ(registration.mapPoints().size(), cells);
  }
  const Pose T = poseFromYpr(0.4, 0, 0, 0.01, 0, 0);
  const RegistrationResult good = step(registration, scene_.frame(T, 0.01, 2), guess);
  EXPECT_TRUE(good.motion.converged()) << good.motion.reason;
  EXPECT_LT((T.inverse() * good.T_odom_vehicle).translation().norm(), 0.03);
}

/** The frame that shows the motion of the first one is not the second: the first one stays where
 * it was. */
TEST_P(Registration, AnEmptySecondFrameLeavesTheFirstInItsPlace)
{
  const std::vector<Pose> poses = drive(6);
  const Preprocessor preprocessor(PreprocessOptions(), pool_);
  LocalMapRegistration registration(options(), pool_);
  Pose motion = Pose::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const Pose T_sweep = poses[0].inverse() * poses[1];
    Frame frame;
    if (i != 1)
    {
      frame.scan = scene_.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), T_sweep);
    }
    frame.cloud = preprocessor.prepare(frame.scan, motion, i == 0 ? 0 : 0.1);
    // The prior of a vehicle whose speed is known.
    motion = T_sweep;
    const RegistrationResult result =
        step(registration, frame, registration.pose() * (i == 0 ? Pose::Identity() : motion), 0.1);
    EXPECT_EQ(result.motion.converged(), i != 1) << i << ": " << result.motion.reason;
    const Pose error = poses[i].inverse() * result.T_odom_vehicle;
    EXPECT_LT(error.translation().norm(), 0.1) << i;
  }
}

/** A registration that max_iterations ends is accepted by its inliers. */
TEST_P(Registration, AScanThatDoesNotSettleIsRegistered)
{
  RefineOptions o = options();
  o.max_iterations = 1;
  LocalMapRegistration registration(o, pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Pose T = poseFromYpr(0.02, 0.06, 0, 0, 0, 0);
  const RegistrationResult result =
      step(registration, scene_.frame(T, 0.01, 2), Pose::Identity(), 0.3);
  EXPECT_EQ(result.motion.status, MotionStatus::not_settled);
  EXPECT_TRUE(result.motion.registered());
  EXPECT_FALSE(result.motion.converged());
  EXPECT_EQ(result.motion.reason, "the registration did not converge");
  EXPECT_LT((T.inverse() * result.T_odom_vehicle).translation().norm(), 0.04) << "not the guess";
  EXPECT_EQ(registration.framesInMap(), 2) << "it is added";
}

TEST_P(Registration, AForeignSceneFailsAndThenRestartsTheMap)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  step(registration, scene_.frame(poseFromYpr(0.1, 0, 0, 0, 0, 0), 0.01, 2), Pose::Identity());
  const Frame foreign = inTheAir(scene_.frame(Pose::Identity(), 0.01, 3));
  const Pose guess = registration.pose();
  for (int i = 0; i < 5; ++i)
  {
    const RegistrationResult result = step(registration, foreign, guess);
    EXPECT_FALSE(result.motion.registered());
    EXPECT_NE(result.motion.reason.find("local map"), std::string::npos);
    EXPECT_EQ(result.motion.map_restarted, i == 4) << i;
  }
  const RegistrationResult after = step(registration, foreign, guess);
  EXPECT_TRUE(after.motion.converged());
  EXPECT_FALSE(after.motion.map_restarted);
}

TEST_P(Registration, AFirstScanOfAPartOfARevolutionIsReplacedAtOnce)
{
  LocalMapRegistration registration(options(), pool_);
  Frame part = scene_.frame(Pose::Identity(), 0.01, 1);
  Cloud& cloud = part.cloud;
  std::vector<Eigen::Vector3f> sector;
  std::copy_if(cloud.points.begin(), cloud.points.end(), std::back_inserter(sector),
               [](const Eigen::Vector3f& p)
               { return p.x() > 0 && std::abs(p.y()) < 0.1F * p.x(); });
  ASSERT_GT(sector.size(), 100U);
  cloud = Cloud();
  cloud.points = sector;
  part.scan = Scan();
  step(registration, part, Pose::Identity());
  const Pose T = poseFromYpr(0.5, 0, 0, 0, 0, 0);
  const RegistrationResult second = step(registration, scene_.frame(T, 0.01, 2), T);
  const RegistrationResult third = step(registration, scene_.frame(T * T, 0.01, 3), T * T);
  EXPECT_TRUE(second.motion.converged() || second.motion.map_restarted) << second.motion.reason;
  EXPECT_TRUE(third.motion.converged()) << third.motion.reason;
}

/** Value and limit of a rejected scan have the same unit, and the value is below the limit. */
TEST_P(Registration, ARejectedScanHasItsRatioAndTheLimit)
{
  for (const double limit : {1.0, 0.995})
  {
    RefineOptions o = options();
    o.min_inlier_ratio = limit;
    LocalMapRegistration registration(o, pool_);
    step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
    const RegistrationResult result =
        step(registration, scene_.frame(Pose::Identity(), 0.01, 2), Pose::Identity(), 0.1);
    ASSERT_FALSE(result.motion.converged());
    double ratio = 0;
    double read_limit = 0;
    ASSERT_EQ(std::sscanf(result.motion.reason.c_str(),
                          "the scan does not fit the local map: inlier ratio %lf, the limit is %lf "
                          "(refine.min_inlier_ratio)",
                          &ratio, &read_limit),
              2)
        << result.motion.reason;
    EXPECT_EQ(read_limit, limit);
    EXPECT_LT(ratio, limit);
    EXPECT_GT(ratio, result.inlier_ratio - 0.01);
    EXPECT_LE(ratio, result.inlier_ratio);
  }
}

/** The rejected motion has deskewed the first frame. */
TEST_P(Registration, ARejectedSecondFrameLeavesTheMapAsItWas)
{
  RefineOptions o = options();
  o.min_inlier_ratio = 1;
  const std::vector<Pose> poses = drive(2);
  const Preprocessor preprocessor(PreprocessOptions(), pool_);
  LocalMapRegistration registration(o, pool_);
  std::vector<Eigen::Vector3f> map_before;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    Frame frame;
    frame.scan = scene_.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), poses[1]);
    frame.cloud = preprocessor.prepare(frame.scan, Pose::Identity(), 0.1);
    const RegistrationResult result = step(registration, frame, Pose::Identity());
    EXPECT_EQ(result.motion.converged(), i == 0);
    EXPECT_TRUE(result.T_odom_vehicle.isApprox(Pose::Identity()));
    map_before = i == 0 ? registration.mapPoints() : map_before;
  }
  EXPECT_FALSE(map_before.empty());
  EXPECT_EQ(registration.framesInMap(), 1);
  EXPECT_EQ(registration.mapPoints(), map_before);
}

TEST_P(Registration, ASolutionThatIsNotFiniteIsRejected)
{
  LocalMapRegistration registration(options(), pool_);
  step(registration, scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const Frame frame = scene_.frame(poseFromYpr(0.05, 0, 0, 0, 0, 0), 0.01, 2);
  MotionPrior prior;
  prior.information.setConstant(std::numeric_limits<double>::quiet_NaN());
  LocalMapRegistration::Alignment alignment =
      registration.align(frame, Pose::Identity(), &prior, 0.1);
  const RegistrationResult result = alignment.result();
  registration.commit(std::move(alignment), frame);
  EXPECT_FALSE(result.motion.converged());
  EXPECT_EQ(result.motion.reason, "the registration has no finite solution");
  EXPECT_TRUE(result.T_odom_vehicle.isApprox(Pose::Identity()));
  EXPECT_EQ(registration.framesInMap(), 1) << "it is not added";
  EXPECT_TRUE(step(registration, frame, Pose::Identity(), 0.1).motion.converged());
}

/** Every n-th of the scene's 32 rings. */
Frame everyRing(int n, Frame frame)
{
  Cloud cloud;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (frame.scan.ring[frame.cloud.source[i]] % n == 0)
    {
      cloud.points.push_back(frame.cloud.points[i]);
      cloud.source.push_back(frame.cloud.source[i]);
    }
  }
  frame.cloud = cloud;
  return frame;
}

/** With cells of one size, sparse rings give fewer surfaces, which does not lower the inlier ratio
 * of those that exist. Rings too far apart give only surfaces of single rings, and no motion;
 * additional larger cells solve it. */
TEST_P(Registration, TheGateSeparatesFewSurfacesFromABadFit)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto registerEvery = [&](int n, int levels)
  {
    RefineOptions o = options();
    o.levels = levels;
    LocalMapRegistration registration(o, pool_);
    step(registration, everyRing(n, scene_.frame(Pose::Identity(), 0.01, 1)), Pose::Identity());
    return step(registration, everyRing(n, scene_.frame(T, 0.01, 2)), T, 0.1);
  };
  const RegistrationResult every_ring = registerEvery(1, 1);
  const RegistrationResult every_second = registerEvery(2, 1);
  EXPECT_TRUE(every_second.motion.converged()) << every_second.motion.reason;
  EXPECT_LT(every_second.surface_share, 0.8 * every_ring.surface_share);
  EXPECT_NEAR(every_second.inlier_ratio, every_ring.inlier_ratio, 0.15);
  const RegistrationResult every_fifth = registerEvery(5, 1);
  EXPECT_FALSE(every_fifth.motion.converged());
  EXPECT_NE(every_fifth.motion.reason.find("refine.cell_size"), std::string::npos)
      << every_fifth.motion.reason;
  const RegistrationResult in_levels = registerEvery(5, 4);
  EXPECT_TRUE(in_levels.motion.converged()) << in_levels.motion.reason;
  EXPECT_LT((T.inverse() * in_levels.T_odom_vehicle).translation().norm(), 0.03);
}

/** The scene, with a third of the rings. */
Frame seenBySparseRings(const test::StreetScene& scene, const Pose& T, unsigned seed)
{
  constexpr int n = 3;
  Frame frame = everyRing(n, scene.frame(T, 0.01, seed));
  for (std::size_t i = 0; i < frame.scan.size(); ++i)
  {
    const int ring = frame.scan.ring[i];
    frame.scan.ring[i] = static_cast<std::uint16_t>(ring / n);
    if (ring % n != 0)
    {
      frame.scan.points[i].setZero();
    }
  }
  return frame;
}

/** With sparse rings the spacing of the rings determines the cells, of the scan's own surfaces too,
 * not the option. */
TEST_P(Registration, CellsAreAsLargeAsSparseRingsRequire)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto poseWith = [&](double cell_size)
  {
    RefineOptions o = options();
    o.cell_size = cell_size;
    LocalMapRegistration registration(o, pool_);
    step(registration, seenBySparseRings(scene_, Pose::Identity(), 1), Pose::Identity());
    return step(registration, seenBySparseRings(scene_, T, 2), Pose::Identity(), 0.1)
        .T_odom_vehicle;
  };
  const Pose found = poseWith(0.3);
  EXPECT_LT((T.inverse() * found).translation().norm(), 0.08) << "registered";
  EXPECT_EQ(found.matrix(), poseWith(0.6).matrix());
}

/** The rings of a further lidar, which have other numbers, change nothing. */
TEST_P(Registration, CellsAreByTheRingsOfTheFirstLidar)
{
  const Pose T = poseFromYpr(0.1, 0.02, 0, 0.005, 0, 0);
  const auto poseWith = [&](bool further)
  {
    const auto frameAt = [&](const Pose& at, unsigned seed)
    {
      Frame frame = seenBySparseRings(scene_, at, seed);
      if (further)  // none of its points is in the cloud
      {
        Scan rear = frame.scan;
        rear.T_vehicle_lidar = poseFromYpr(-1, 0, 1, M_PI, -0.1, 0);
        appendScan(rear, 1, frame.scan);
      }
      return frame;
    };
    LocalMapRegistration registration(options(), pool_);
    step(registration, frameAt(Pose::Identity(), 1), Pose::Identity());
    return step(registration, frameAt(T, 2), Pose::Identity(), 0.1).T_odom_vehicle;
  };
  EXPECT_EQ(poseWith(true).matrix(), poseWith(false).matrix());
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
                         [](const testing::TestParamInfo<RefineMethod>& test_info) {
                           return test_info.param == RefineMethod::gicp ? "gicp" : "point_to_plane";
                         });

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
  constexpr int kColumnsPerMeter = 10;
  std::mt19937 generator(static_cast<unsigned>(x));
  std::normal_distribution<float> noise(0, 0.01F);
  std::uniform_real_distribution<float> within_step(-0.5F, 0.5F);
  std::vector<Eigen::Vector3f> points;
  const auto add = [&](float along, float across, float up)
  {
    points.push_back(Eigen::Vector3f{along + noise(generator), across + noise(generator),
                                     up + noise(generator)});
  };
  for (int k = -15 * kColumnsPerMeter; k <= 15 * kColumnsPerMeter; ++k)
  {
    const int in_period = (k + x * kColumnsPerMeter + 1700) % 170;
    const bool pillar = in_period % 40 < 8 && in_period < 160;
    const bool face = (in_period % 40 == 0 || in_period % 40 == 8) && in_period < 160;
    for (int j = 0; j < 12; ++j)
    {
      const float along = (static_cast<float>(k) + within_step(generator)) / kColumnsPerMeter;
      const float up = 0.25F * (static_cast<float>(j) + within_step(generator));
      add(along, up - 1.5F, 0);
      for (const float side : {-1.0F, 1.0F})
      {
        add(along, side * (pillar ? 2.2F : 3.0F), up);
        for (int i = 0; face && i < 8; ++i)
        {
          const float across = 2.2F + 0.1F * (static_cast<float>(i) + within_step(generator));
          add(static_cast<float>(k) / kColumnsPerMeter, side * across, up);
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
