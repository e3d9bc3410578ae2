// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "../src/StartSearch.h"

namespace dyslam
{
namespace
{
TEST(StartSpeed, IsThatUnderWhichTheScansFitBest)
{
  const std::vector<StartRun> runs{{-4, 2.1}, {1, 2.2}, {13, 2.6}, {27, 3.1}, {26, 3.0}, {40, 2.0}};
  EXPECT_EQ(bestStartSpeed(runs, {0.5, 2.2}, 0.5, {}), 27);
  EXPECT_FALSE(bestStartSpeed(runs, {27.2, 3.1}, 27.2, {})) << "the odometry's own";
  EXPECT_FALSE(bestStartSpeed(runs, {5, 3.2}, 5, {})) << "the odometry's own fits better";
  EXPECT_FALSE(bestStartSpeed(runs, {5, 3.09}, 5, {})) << "hardly better";
  EXPECT_FALSE(bestStartSpeed(runs, {24, 2.9}, 26.5, {})) << "the odometry finds it";
  EXPECT_EQ(bestStartSpeed(runs, {26.8, 3.1}, 30, {}), 26.8) << "the odometry is slow to find it";
  EXPECT_FALSE(bestStartSpeed({{4, 3}}, {2, 2}, 2, {})) << "a jam";
  EXPECT_FALSE(bestStartSpeed({{4, 3}}, {4.2, 2.9}, 2, {})) << "a jam; the odometry will find it";
  EXPECT_FALSE(bestStartSpeed({}, {5, 3}, 5, {}));
}

TEST(StartSpeed, AnImpossibleSpeedIsNotFound)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(bestStartSpeed({{nan, 9}, {99, 9}, {-49, 9}, {20, nan}}, {5, 3}, 5, {}));
}

TEST(StartSpeed, ScansWithoutInliersDoNotImproveTheFit)
{
  MotionEstimate fitting;
  fitting.inliers = 400;
  fitting.rmse = 0.05;
  FitMean all;
  FitMean most;
  for (int i = 0; i < 10; ++i)
  {
    all.add(fitting, 1000);
    most.add(i < 8 ? fitting : MotionEstimate(), 1000);  // then it has left the map
  }
  EXPECT_NEAR(all.value(), 0.4 / (0.05 * 0.05), 1e-9);
  EXPECT_NEAR(most.value(), 0.8 * all.value(), 1e-9);
  EXPECT_EQ(FitMean().value(), 0);
}

TEST(StartSpeed, IsSetWithItsDeviation)
{
  Config config = Config::fromText("[start]\nsigma = 2.5\n[odometry]\nmethod = gicp\n", "test");
  setStartSpeed(26.7123, config);
  const Config::Section& odometry = config.section("odometry");
  EXPECT_EQ("26.7", odometry.at("start_speed").text);
  EXPECT_EQ(2.5, std::stod(odometry.at("start_speed_sigma").text));
  EXPECT_EQ("gicp", odometry.at("method").text);
  EXPECT_FALSE(findStartSpeed(std::vector<Frame>(20), config)) << "it is known now";
  for (const double standing : {0.02, -0.02, 0.0})
  {
    setStartSpeed(standing, config);
    EXPECT_EQ("0.001", odometry.at("start_speed").text) << "zero would mean an unknown speed";
  }
  Config bad = Config::fromText("[start]\nsigma = -1\n", "test");
  EXPECT_THROW(setStartSpeed(3, bad), UserError);
}

/** Settings for scans whose points are all measured at one moment, without a network. */
Config simpleConfig(const std::string& more)
{
  return Config::fromText("[dyseg]\nmethod = none\n[preprocess]\ndeskew = none\n" + more, "test");
}

/** Scans of a room with pillars, 0.5 m apart. \param period between their time stamps [s] */
std::vector<Frame> driveThroughRoom(double period)
{
  std::vector<Frame> frames(20);
  for (std::size_t k = 0; k < frames.size(); ++k)
  {
    Scan& scan = frames[k].scan;
    frames[k].index = k;
    scan.stamp = period * static_cast<double>(k);
    const float at = 0.5F * static_cast<float>(k);
    const auto add = [&](float x, float y, float z) { scan.points.emplace_back(x - at, y, z); };
    for (float z = -1.7F; z < 3; z += 0.4F)
    {
      for (float s = -30; s < 40; s += 0.15F)
      {
        add(s, -8, z);
        add(s, 9, z);
      }
      for (float s = -8; s < 9; s += 0.15F)
      {
        add(-30, s, z);
        add(40, s, z);
        add(7.3F * std::floor(s), s - 2 * std::floor(s / 2), z);
      }
    }
  }
  return frames;
}

/** Scans between smooth walls, which look the same at every speed. */
std::vector<Frame> driveBetweenWalls(std::size_t count)
{
  std::vector<Frame> frames(count);
  for (std::size_t k = 0; k < frames.size(); ++k)
  {
    Scan& scan = frames[k].scan;
    frames[k].index = k;
    scan.stamp = 0.05 * static_cast<double>(k);
    for (float z = -1.7F; z < 3; z += 0.4F)
    {
      for (float x = -40; x < 40; x += 0.25F)
      {
        scan.points.emplace_back(x, -8, z);
        scan.points.emplace_back(x, 9, z);
      }
    }
    for (float x = -20; x < 20; x += 0.5F)
    {
      for (float y = -8; y < 9; y += 0.5F)
      {
        scan.points.emplace_back(x, y, -1.7F);
      }
    }
  }
  return frames;
}

TEST(StartSpeed, MoreScansAreComparedWhereTheFirstOnesLeaveItOpen)
{
  const Config config =
      simpleConfig("[motion]\nstart_speed_sigma = 1\n[start]\nfastest = 10\ncompared_scans = 15\n");
  const std::vector<Frame> frames = driveBetweenWalls(20);
  std::size_t read = 0;
  const auto next = [&] { return std::optional<Frame>(frames.at(read++)); };
  (void)findStartSpeed(next, config);
  EXPECT_EQ(read, 15U);
}

TEST(StartSpeed, NoFurtherScansAreReadWhereTheFirstOnesDetermineIt)
{
  const Config config = simpleConfig("[pipeline]\nthreads = 1\n");
  const std::vector<Frame> frames = driveThroughRoom(0.1);
  std::size_t read = 0;
  const auto next = [&] { return std::optional<Frame>(frames.at(read++)); };
  EXPECT_FALSE(findStartSpeed(next, config));
  EXPECT_EQ(read, 10U);
}

TEST(StartSpeed, IsMeasuredByWheelsWithSamplesUpToTheSecondScan)
{
  const auto isMeasured = [](std::size_t first_with_wheels)
  {
    const Config config;
    std::size_t read = 0;
    const NextScan next = [&]
    {
      Frame frame;
      frame.index = read++;
      frame.scan.stamp = 0.1 * static_cast<double>(frame.index);
      if (frame.index >= first_with_wheels)
      {
        frame.wheels.push_back({frame.scan.stamp - 0.01, 3});
      }
      return std::optional<Frame>(frame);
    };
    StartSearch search(next, config);
    search.readTo(10);
    return search.isMeasured();
  };
  EXPECT_TRUE(isMeasured(0));
  EXPECT_TRUE(isMeasured(1));
  EXPECT_FALSE(isMeasured(2)) << "the odometry does not know them at its first motion";
  EXPECT_FALSE(isMeasured(5));
}

/** The drive through the room at 5 m/s, with wheels that state another speed. */
std::optional<SpeedContradiction> contradictionAt(double by_wheels, const std::string& more = "")
{
  std::vector<Frame> frames = driveThroughRoom(0.1);
  for (Frame& frame : frames)
  {
    frame.wheels.push_back({frame.scan.stamp - 0.01, by_wheels});
  }
  return findWheelContradiction(frames, simpleConfig("[pipeline]\nthreads = 1\n" + more));
}

TEST(StartSpeed, OfTheWheelsIsComparedWithThatOfTheScans)
{
  EXPECT_FALSE(contradictionAt(5.4)) << "an error of their scale";
  for (const double wrong : {40.0, 0.05})
  {
    const auto contradiction = contradictionAt(wrong);
    ASSERT_TRUE(contradiction) << wrong;
    EXPECT_NEAR(contradiction->by_wheels, wrong, 1e-6);
    EXPECT_NEAR(contradiction->by_scans, 5, 0.1);
  }
  EXPECT_FALSE(contradictionAt(40, "[start]\nsearch = false\n"));
  EXPECT_FALSE(findWheelContradiction(driveThroughRoom(0.1), simpleConfig(""))) << "no wheels";
}

TEST(StartSpeed, AContradictionOfTheWheelsNamesBothSpeeds)
{
  for (const bool are_used : {false, true})
  {
    const std::string warning = warningOf({27.56, 7.66}, are_used);
    EXPECT_NE(warning.find("it states 27.6 m/s"), std::string::npos) << warning;
    EXPECT_NE(warning.find("the scans show 7.7 m/s"), std::string::npos) << warning;
    EXPECT_EQ(are_used, warning.find("is not used") == std::string::npos) << warning;
  }
}

TEST(StartSpeed, IsNotSearchedForWhereTimeStampsAreWrong)
{
  // 0.5 m in 4 ms: faster than any start speed.
  const Config config = simpleConfig("[pipeline]\nthreads = 1\n");
  std::optional<double> found;
  EXPECT_NO_THROW(found = findStartSpeed(driveThroughRoom(0.004), config));
  EXPECT_FALSE(found);
}
}  // namespace
}  // namespace dyslam
