// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/odometry/LocalMapRefinement.h>
#include <dyslam/odometry/Preprocessor.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "TestScene.h"

namespace dyslam
{
namespace
{
constexpr double degree = 3.14159265358979323846 / 180;

class Refinement : public testing::TestWithParam<RefineMethod>
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

/** A drive along a bend, every frame skewed by its own motion. */
std::vector<Pose> drive(int frames)
{
  std::vector<Pose> poses{Pose::Identity()};
  for (int i = 1; i < frames; ++i)
  {
    poses.push_back(poses.back() * poseFromYpr(0.8, 0.02, 0, 0.8 * degree, 0, 0));
  }
  return poses;
}

/** Runs the line of preprocessing and refinement with the constant-velocity prediction. */
std::vector<RefineResult> run(const test::StreetScene& scene,
                              const std::vector<Pose>& poses,
                              const RefineOptions& options,
                              ThreadPool& pool)
{
  const Preprocessor preprocessor(PreprocessOptions(), pool);
  LocalMapRefinement refinement(options, pool);
  std::vector<RefineResult> results;
  Pose motion = Pose::Identity();
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const Pose T_sweep = poses.size() < 2 ? Pose::Identity()
                         : i == 0         ? Pose(poses[0].inverse() * poses[1])
                                          : Pose(poses[i - 1].inverse() * poses[i]);
    Frame frame;
    frame.scan = scene.scan(poses[i], 0.01, static_cast<unsigned>(i + 1), T_sweep);
    frame.cloud = preprocessor.prepare(frame.scan, motion, 0.1);
    results.push_back(refinement.refine(frame, refinement.pose() * motion));
    motion = results.back().motion.T_previous_current;
  }
  return results;
}

TEST_P(Refinement, FollowsADriveFromAStartInMotion)
{
  const std::vector<Pose> poses = drive(10);
  const std::vector<RefineResult> results = run(scene_, poses, options(), pool_);
  for (std::size_t i = 1; i < poses.size(); ++i)
  {
    EXPECT_TRUE(results[i].motion.converged) << i << ": " << results[i].motion.reason;
    EXPECT_FALSE(results[i].degenerate);
    const Pose error = poses[i].inverse() * results[i].T_odom_vehicle;
    EXPECT_LT(error.translation().norm(), 0.05) << i;
    EXPECT_LT(rotationAngle(error), 0.2 * degree) << i;
  }
}

TEST_P(Refinement, StartDeviationHoldsForOneRegistration)
{
  LocalMapRefinement refinement(options(), pool_);
  refinement.setStartDeviation(0.01);
  (void)refinement.refine(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  std::vector<Eigen::Vector3f> sky;
  for (int i = 0; i < 400; ++i)
  {
    const float x = static_cast<float>(i % 20), y = static_cast<float>(i / 20);
    sky.emplace_back(x, y, 60 + 0.1F * x * y);
  }
  EXPECT_FALSE(refinement.refine(test::frameOf(sky), Pose::Identity()).motion.converged);
  // The next one may be as wrong as the options say.
  const Pose T = poseFromYpr(1.6, 0.1, 0, 2 * degree, 0, 0);
  const RefineResult found = refinement.refine(scene_.frame(T, 0.01, 2), Pose::Identity());
  EXPECT_TRUE(found.motion.converged) << found.motion.reason;
  EXPECT_LT((T.inverse() * found.T_odom_vehicle).translation().norm(), 0.05);
}

TEST_P(Refinement, MotionsChainToThePoses)
{
  Pose T = Pose::Identity();
  for (const RefineResult& result : run(scene_, drive(5), options(), pool_))
  {
    T = T * result.motion.T_previous_current;
    EXPECT_TRUE(T.isApprox(result.T_odom_vehicle, 1e-9));
  }
}

TEST_P(Refinement, SameBytesForAnyNumberOfThreads)
{
  ThreadPool one(1);
  ThreadPool three(3);
  const std::vector<RefineResult> a = run(scene_, drive(4), options(), one);
  const std::vector<RefineResult> b = run(scene_, drive(4), options(), three);
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    EXPECT_EQ(a[i].T_odom_vehicle.matrix(), b[i].T_odom_vehicle.matrix());
    EXPECT_EQ(a[i].motion.information, b[i].motion.information);
    EXPECT_EQ(a[i].map_cells, b[i].map_cells);
  }
}

TEST_P(Refinement, UselessFramesKeepTheGuessAndTheMap)
{
  LocalMapRefinement refinement(options(), pool_);
  refinement.refine(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  const std::size_t cells = refinement.mapPoints().size();
  const Pose guess = poseFromYpr(0.3, 0, 0, 0, 0, 0);
  for (const Frame& frame : {test::frameOf({}), test::frameOf({{1, 2, 3}}),
                             test::frameOf(std::vector<Eigen::Vector3f>(500, test::nanPoint()))})
  {
    const RefineResult result = refinement.refine(frame, guess);
    EXPECT_FALSE(result.motion.converged);
    EXPECT_FALSE(result.motion.reason.empty());
    EXPECT_TRUE(result.T_odom_vehicle.isApprox(guess));
    EXPECT_EQ(refinement.mapPoints().size(), cells);
  }
  const Pose T = poseFromYpr(0.4, 0, 0, 0.01, 0, 0);
  const RefineResult good = refinement.refine(scene_.frame(T, 0.01, 2), guess);
  EXPECT_TRUE(good.motion.converged) << good.motion.reason;
  EXPECT_LT((T.inverse() * good.T_odom_vehicle).translation().norm(), 0.03);
}

TEST_P(Refinement, AForeignSceneFailsAndThenBeginsAnew)
{
  LocalMapRefinement refinement(options(), pool_);
  refinement.refine(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  refinement.refine(scene_.frame(poseFromYpr(0.1, 0, 0, 0, 0, 0), 0.01, 2), Pose::Identity());
  // Points in the air where the map has nothing.
  Frame foreign = scene_.frame(Pose::Identity(), 0.01, 3);
  for (Eigen::Vector3f& p : foreign.cloud.points)
  {
    p.z() += 40;
  }
  const Pose guess = refinement.pose();
  for (int i = 0; i < 5; ++i)
  {
    const RefineResult result = refinement.refine(foreign, guess);
    EXPECT_FALSE(result.motion.converged);
    EXPECT_NE(result.motion.reason.find("does not fit"), std::string::npos);
  }
  EXPECT_TRUE(refinement.refine(foreign, guess).motion.converged);
}

TEST_P(Refinement, MovingPointsCanBeWeighedOut)
{
  const Pose T = poseFromYpr(0.4, 0, 0, 0.01, 0, 0);
  LocalMapRefinement refinement(options(), pool_);
  refinement.refine(scene_.frame(Pose::Identity(), 0.01, 1), Pose::Identity());
  Frame frame = scene_.frame(T, 0.01, 2);
  for (Eigen::Vector3f& p : frame.cloud.points)
  {
    const bool moves = p.z() > 0.3F && (p.y() > 0 || p.x() > 25);
    p.x() += moves ? 0.3F : 0.0F;
    frame.moving_probability.push_back(moves ? 1.0F : 0.0F);
  }
  const RefineResult result = refinement.refine(frame, T);
  EXPECT_LT((T.inverse() * result.T_odom_vehicle).translation().norm(), 0.03);
  for (const Eigen::Vector3f& p : refinement.mapPoints())
  {
    EXPECT_LT(p.z(), 20);
  }
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         Refinement,
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

TEST(RefinementInOpenScenes, GuessIsKeptWhereTheSceneIsOpenAndSaidSo)
{
  ThreadPool pool(2);
  for (const bool tunnel : {false, true})
  {
    LocalMapRefinement refinement(RefineOptions(), pool);
    refinement.refine(openScene(tunnel, Pose::Identity()), Pose::Identity());
    Pose guess = Pose::Identity();
    RefineResult result;
    for (int i = 1; i <= 4; ++i)
    {
      guess.translation().x() = 0.5 * i;
      Pose T = guess;
      T.translation().z() = 0.05;
      result = refinement.refine(openScene(tunnel, T), guess);
    }
    EXPECT_TRUE(result.degenerate) << "tunnel " << tunnel;
    EXPECT_NEAR(result.T_odom_vehicle.translation().x(), 2, 0.1) << "tunnel " << tunnel;
    EXPECT_NEAR(result.T_odom_vehicle.translation().z(), 0.05, 0.02) << "tunnel " << tunnel;
    // Trusted along z, hardly along x.
    const Matrix6 covariance = result.motion.information.inverse();
    EXPECT_GT(covariance(0, 0), 30 * covariance(2, 2)) << "tunnel " << tunnel;
    EXPECT_GT(covariance(0, 0), 0.01) << "tunnel " << tunnel;
  }
}

TEST(RefinementMethod, NoneTakesTheGuessAndKeepsNoMap)
{
  ThreadPool pool(1);
  RefineOptions options;
  options.method = RefineMethod::none;
  LocalMapRefinement refinement(options, pool);
  Frame frame = test::StreetScene().frame(Pose::Identity(), 0.01, 1);
  frame.odometry.converged = true;
  frame.odometry.information *= 7;
  const Pose guess = poseFromYpr(1, 2, 3, 0.1, 0.2, 0.3);
  const RefineResult result = refinement.refine(frame, guess);
  EXPECT_TRUE(result.T_odom_vehicle.isApprox(guess));
  EXPECT_EQ(result.motion.information, frame.odometry.information);
  EXPECT_TRUE(refinement.mapPoints().empty());
}

TEST(RefinementMap, StaysBoundedOnALongDrive)
{
  ThreadPool pool(2);
  RefineOptions options;
  options.map_radius = 20;
  LocalMapRefinement refinement(options, pool);
  std::size_t most_early = 0;
  std::size_t most_late = 0;
  for (int i = 0; i < 120; ++i)
  {
    Pose T = Pose::Identity();
    T.translation().x() = i;
    // The same corridor everywhere, with ribs that show the way.
    std::vector<Eigen::Vector3f> points;
    for (int k = -150; k <= 150; ++k)
    {
      const float x = 0.1F * static_cast<float>(k);
      const bool rib = ((k + 10 * i) % 40 + 40) % 40 < 8;
      for (int j = 0; j < 12; ++j)
      {
        const float u = 0.25F * static_cast<float>(j);
        points.emplace_back(x, u - 1.5F, 0.0F);
        points.emplace_back(x, rib ? 2.6F : 3.0F, u);
        points.emplace_back(x, rib ? -2.6F : -3.0F, u);
      }
    }
    const RefineResult result = refinement.refine(test::frameOf(points), T);
    (i < 60 ? most_early : most_late) = std::max(i < 60 ? most_early : most_late, result.map_cells);
  }
  EXPECT_LT(most_late, most_early + most_early / 5);
}

TEST(RefinementOptions, AreChecked)
{
  ThreadPool pool(1);
  RefineOptions options;
  options.cell_size = 0;
  EXPECT_THROW(LocalMapRefinement(options, pool), UserError);
}
}  // namespace
}  // namespace dyslam
