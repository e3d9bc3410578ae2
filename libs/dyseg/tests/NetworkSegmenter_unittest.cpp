// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/dyseg/NetworkSegmenter.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>
#include <string>

namespace
{
using dyslam::Frame;
using dyslam::NetworkSegmenter;
using dyslam::NetworkSegmenterOptions;
using dyslam::poseFromYpr;

/** A street of walls and poles as a spinning sensor 1.7 m above flat ground would see it. */
std::vector<Eigen::Vector3f> street(unsigned seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, 0.015F);
  std::vector<Eigen::Vector3f> posts;
  std::mt19937 places(7);
  std::uniform_real_distribution<float> where(-40, 40);
  for (int i = 0; i < 150; ++i)
  {
    posts.emplace_back(where(places), where(places), 0.15F + 0.5F * std::abs(where(places)) / 40);
  }
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < 64; ++row)
  {
    const float slope = -0.44F + 0.0075F * static_cast<float>(row);
    for (int column = 0; column < 1800; ++column)
    {
      const float azimuth = 0.00349066F * static_cast<float>(column);
      const Eigen::Vector2f d(std::cos(azimuth), std::sin(azimuth));
      float flat = slope < -0.02F ? -1.7F / slope : 80;
      for (const auto& post : posts)
      {
        const float along = post.head<2>().dot(d);
        const float across2 = post.head<2>().squaredNorm() - along * along;
        if (along > 1 && across2 < post.z() * post.z())
        {
          flat = std::min(flat, along - std::sqrt(post.z() * post.z() - across2));
        }
      }
      if (flat < 70)
      {
        flat += noise(random);
        points.emplace_back(flat * d.x(), flat * d.y(), flat * slope);
      }
    }
  }
  return points;
}

Frame frameOf(std::vector<Eigen::Vector3f> points, std::size_t index)
{
  Frame frame;
  frame.index = index;
  frame.cloud.points = std::move(points);
  return frame;
}

TEST(NetworkSegmenter, TheFirstScanIsStatic)
{
  NetworkSegmenter segmenter{NetworkSegmenterOptions()};
  auto frame = frameOf(street(1), 0);
  segmenter.segment(frame);
  ASSERT_EQ(frame.moving_probability.size(), frame.cloud.points.size());
  EXPECT_EQ(*std::max_element(frame.moving_probability.begin(), frame.moving_probability.end()), 0);
  EXPECT_FALSE(segmenter.motionToEarlier().has_value());
}

TEST(NetworkSegmenter, AppearanceCountsUntilTheFirstGapIsReached)
{
  NetworkSegmenterOptions options;
  options.first_gap = 2;
  NetworkSegmenter segmenter(options);
  for (std::size_t i = 0; i < 4; ++i)
  {
    auto frame = frameOf(street(static_cast<unsigned>(i)), i);
    segmenter.segment(frame);
    const std::vector<float>& prior = frame.static_prior;
    ASSERT_EQ(!prior.empty(), i < 2) << i;
    if (prior.empty())
    {
      continue;
    }
    ASSERT_EQ(prior.size(), frame.cloud.points.size());
    EXPECT_EQ(prior.front(), 1.0F) << "ground is static";
    EXPECT_LT(*std::min_element(prior.begin(), prior.end()), 1.0F);
    EXPECT_GE(*std::min_element(prior.begin(), prior.end()), 0.0F);
  }
}

/** Static scans with a prior and poses of 1 m per scan: they are the start of the search, not its
 * result. */
TEST(NetworkSegmenter, TheSearchIsAroundThePriorOnceTheFirstGapIsReached)
{
  struct Motions
  {
    std::vector<double> step;     //!< to the scan before, as far as it was estimated
    std::vector<double> to_past;  //!< to the scan that was compared with
  };
  const auto motions = [](const std::string& search)
  {
    NetworkSegmenterOptions options;
    options.search = search;
    options.first_gap = 2;
    NetworkSegmenter segmenter(options);
    Motions m;
    for (std::size_t i = 0; i < 4; ++i)
    {
      auto frame = frameOf(street(static_cast<unsigned>(i)), i);
      frame.prior.T_previous_current = poseFromYpr(1, 0, 0, 0, 0, 0);
      frame.prior.reliable = true;
      frame.T_odom_vehicle = poseFromYpr(static_cast<double>(i), 0, 0, 0, 0, 0);
      segmenter.segment(frame);
      if (i > 0)
      {
        m.to_past.push_back(segmenter.motionToEarlier()->T_previous_current.translation().x());
      }
      if (frame.segmenter_motion)
      {
        m.step.push_back(frame.segmenter_motion->T_previous_current.translation().x());
      }
    }
    return m;
  };
  const Motions global = motions("global");
  const Motions automatic = motions("auto");
  const Motions around_prior = motions("prior");
  EXPECT_EQ(global.step.size(), 3U);
  EXPECT_EQ(automatic.step.size(), 1U) << "the odometry gives it afterwards";
  EXPECT_EQ(automatic.step[0], global.step[0]);
  EXPECT_EQ(automatic.to_past[0], global.to_past[0]);
  EXPECT_NE(automatic.to_past[1], global.to_past[1]);
  EXPECT_NE(around_prior.step[0], global.step[0]);
  for (const Motions& m : {global, automatic, around_prior})
  {
    for (const double x : m.step)
    {
      EXPECT_NEAR(x, 0, 0.15) << "less than a cell of the grid";
    }
    for (const double x : m.to_past)
    {
      EXPECT_NEAR(x, 0, 0.15) << "less than a cell of the grid";
    }
  }
}

/** A scan without points shows no motion: the vehicle moves on by the prior. */
TEST(NetworkSegmenter, TheStaticMotionIsThePriorsWhereItCannotBeFound)
{
  NetworkSegmenterOptions options;
  options.search = "global";
  options.first_gap = 2;
  NetworkSegmenter segmenter(options);
  for (std::size_t i = 0; i < 3; ++i)
  {
    auto frame = frameOf(i == 1 ? std::vector<Eigen::Vector3f>() : street(1), i);
    frame.prior.T_previous_current = poseFromYpr(1, 0, 0, 0, 0, 0);
    segmenter.segment(frame);
    EXPECT_FALSE(frame.segmenter_motion.has_value()) << i;
    if (i == 1)
    {
      const auto& motion = *segmenter.motionToEarlier();
      EXPECT_FALSE(motion.converged());
      EXPECT_NEAR(motion.T_previous_current.translation().x(), 1, 1e-9);
    }
  }
}

/** The networks shipped with DySLAM, by the name of their weights. */
class ShippedWeights : public ::testing::TestWithParam<std::string>
{
 protected:
  [[nodiscard]] static NetworkSegmenterOptions options()
  {
    NetworkSegmenterOptions options;
    options.weights = GetParam();
    return options;
  }
};

TEST_P(ShippedWeights, ShiftedScanGivesTheShiftAndNoMovers)
{
  NetworkSegmenter segmenter(options());
  const auto now = street(1);
  // The same scan again as an ego that moved would see it: nothing in it moves.
  const auto truth = poseFromYpr(0.9, 0.05, 0, 0.02, 0, 0);
  auto before = now;
  for (auto& p : before)
  {
    p = truth.cast<float>() * p;
  }
  auto first = frameOf(before, 0);
  auto second = frameOf(now, 1);
  segmenter.segment(first);
  segmenter.segment(second);
  ASSERT_TRUE(segmenter.motionToEarlier().has_value());
  const auto& motion = *segmenter.motionToEarlier();
  EXPECT_TRUE(motion.converged());
  EXPECT_LT((motion.T_previous_current.translation() - truth.translation()).norm(), 0.15);
  EXPECT_LT(dyslam::rotationAngle(motion.T_previous_current.inverse() * truth), 0.01);
  const auto moving =
      std::count_if(second.moving_probability.begin(), second.moving_probability.end(),
                    [](float p) { return p > 0.5F; });
  EXPECT_LT(static_cast<double>(moving), 0.005 * static_cast<double>(now.size()));
}

/** A car of 4.2 x 1.8 x 1.5 m on the ground stops the rays that hit it. \return its points */
std::vector<std::size_t> addCar(const Eigen::Vector2f& centre, std::vector<Eigen::Vector3f>& points)
{
  const Eigen::Array3f low(centre.x() - 2.1F, centre.y() - 0.9F, -1.6F);
  const Eigen::Array3f high(centre.x() + 2.1F, centre.y() + 0.9F, -0.1F);
  std::vector<std::size_t> on_car;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    // Fractions of the ray at which it enters and leaves the box.
    const Eigen::Array3f to_low = low / points[i].array();
    const Eigen::Array3f to_high = high / points[i].array();
    const float enter = to_low.min(to_high).maxCoeff();
    const float leave = to_low.max(to_high).minCoeff();
    if (0 < enter && enter < std::min(leave, 1.0F))
    {
      points[i] *= enter;
      on_car.push_back(i);
    }
  }
  return on_car;
}

TEST_P(ShippedWeights, FindACarThatMovesAndNoneThatStands)
{
  NetworkSegmenter segmenter(options());
  Frame frame;
  std::vector<std::size_t> driving;
  std::vector<std::size_t> parked;
  for (std::size_t scan = 0; scan <= 8; ++scan)
  {
    frame = frameOf(street(static_cast<unsigned>(scan)), scan);
    frame.prior.reliable = true;  // the ego stands
    driving = addCar({4 + static_cast<float>(scan), 4}, frame.cloud.points);
    parked = addCar({8, -4}, frame.cloud.points);
    segmenter.segment(frame);
  }
  const auto moving_share = [&](const std::vector<std::size_t>& points)
  {
    const auto moving =
        std::count_if(points.begin(), points.end(),
                      [&](std::size_t i) { return frame.moving_probability[i] > 0.5F; });
    return static_cast<double>(moving) / static_cast<double>(points.size());
  };
  ASSERT_GT(driving.size(), 200U);
  ASSERT_GT(parked.size(), 200U);
  EXPECT_GT(moving_share(driving), 0.6);
  EXPECT_LT(moving_share(parked), 0.02);
}

INSTANTIATE_TEST_SUITE_P(NetworkSegmenter,
                         ShippedWeights,
                         ::testing::Values("dyseg", "dyseg_simulated"));

TEST(NetworkSegmenter, EmptyAndInvalidScans)
{
  NetworkSegmenter segmenter{NetworkSegmenterOptions()};
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const auto& points :
       {std::vector<Eigen::Vector3f>{}, std::vector<Eigen::Vector3f>{{1, 2, 3}},
        std::vector<Eigen::Vector3f>{{nan, nan, nan}, {5, 5, 0}}, street(2)})
  {
    auto frame = frameOf(points, 0);
    segmenter.segment(frame);
    EXPECT_EQ(frame.moving_probability.size(), points.size());
  }
}

TEST(NetworkSegmenter, ForeignWeightsAreAClearError)
{
  const std::string file = ::testing::TempDir() + "/not_dyseg.safetensors";
  std::ofstream(file) << "these are no weights";
  NetworkSegmenterOptions options;
  options.weights = file;
  try
  {
    const NetworkSegmenter segmenter{options};
    FAIL() << "taken for weights";
  }
  catch (const dyslam::UserError& error)
  {
    EXPECT_EQ(std::string(error.what()).rfind("dyseg_network.weights: " + file, 0), 0U)
        << error.what();
  }
  // The odometry's weights are not DySeg's either.
  options.weights = "dylo";
  EXPECT_THROW(NetworkSegmenter{options}, dyslam::UserError);
}

TEST(NetworkSegmenter, MissingWeightsAreAClearError)
{
  NetworkSegmenterOptions options;
  options.weights = "/nowhere/weights.safetensors";
  EXPECT_THROW(NetworkSegmenter{options}, dyslam::UserError);
}
}  // namespace
