// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/train/DysegBodies.h>
#include <dyslam/train/DysegData.h>
#include <dyslam/train/LabelledRun.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace
{
using dyslam::BodyKind;
using dyslam::DysegSample;
using dyslam::Pose;
using dyslam::poseFromYpr;
using dyslam::RandomDraws;

/** A room: rays in all directions meet a cylinder of 30 m around the sensor or the ground. */
std::vector<Eigen::Vector3f> room()
{
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < 40; ++row)
  {
    const float slope = -0.4F + 0.012F * static_cast<float>(row);
    for (int column = 0; column < 1000; ++column)
    {
      const float azimuth = 0.0062832F * static_cast<float>(column);
      float flat = 30;
      flat = slope < 0 ? std::min(flat, -1.7F / slope) : flat;
      points.emplace_back(flat * std::cos(azimuth), flat * std::sin(azimuth), flat * slope);
    }
  }
  return points;
}

TEST(CastBody, PointsLieOnTheBodyAndOnTheirRays)
{
  RandomDraws draws(1, 1);
  const auto box = dyslam::assembleBody(BodyKind::random, {{{0, 0, 1}, {2, 1, 1}, false}});
  const auto before = room();
  auto points = before;
  const Pose pose = poseFromYpr(12, 3, -1.7, 0.5, 0, 0);
  const auto on = dyslam::castBody(box, pose, 0, draws, points);
  ASSERT_GT(on.size(), 50U);
  std::vector<bool> changed(points.size(), false);
  for (const auto i : on)
  {
    changed[i] = true;
    const Eigen::Vector3d p = pose.inverse() * points[i].cast<double>() - Eigen::Vector3d(0, 0, 1);
    const Eigen::Array3d share = p.array().abs() / Eigen::Array3d(2, 1, 1);
    EXPECT_NEAR(share.maxCoeff(), 1, 1e-3);
    EXPECT_LT((points[i].normalized() - before[i].normalized()).norm(), 1e-5);
    EXPECT_LT(points[i].norm(), before[i].norm());
  }
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    EXPECT_TRUE(changed[i] || points[i] == before[i]);
    // No ray may still end behind the body: brute force over the box.
    if (!changed[i])
    {
      bool through = false;
      for (float s = 0.02F; s < 0.99F && !through; s += 0.005F)
      {
        const Eigen::Vector3d p =
            pose.inverse() * (s * before[i]).cast<double>() - Eigen::Vector3d(0, 0, 1);
        through = (p.array().abs() < Eigen::Array3d(1.95, 0.95, 0.95)).all();
      }
      EXPECT_FALSE(through) << i;
    }
  }
}

TEST(CastBody, EveryKindIsSeenUnlessItIsAroundTheSensor)
{
  for (const auto kind : {BodyKind::car, BodyKind::van, BodyKind::truck, BodyKind::pedestrian,
                          BodyKind::cyclist, BodyKind::random})
  {
    RandomDraws draws(2, 3);
    const auto body = dyslam::makeBody(kind, draws);
    auto points = room();
    const auto on =
        dyslam::castBody(body, poseFromYpr(8, 0, -1.7, 0.7, 0, 0), 0.02F, draws, points);
    EXPECT_GT(on.size(), 20U) << static_cast<int>(kind);
    auto around_sensor = room();
    EXPECT_TRUE(dyslam::castBody(body, Pose::Identity(), 0, draws, around_sensor).empty())
        << static_cast<int>(kind);
  }
}

TEST(DysegSample, FlowTakesPointsToWhereTheyWere)
{
  dyslam::DysegClip clip;
  clip.frames.resize(2);
  auto& then = clip.frames[0];
  auto& now = clip.frames[1];
  now.T_world_sensor = poseFromYpr(1, 0, 0, 0.1, 0, 0);
  now.points = {{10, 0, 0}, {5, 5, 0}, {3, 3, 3}};
  now.object = {0, 7, dyslam::DysegClip::unknown};
  now.points.resize(now.points.size() + dyslam::min_mover_points, {5, 5, 0});
  now.object.resize(now.points.size(), 7);
  now.objects[7].moving = true;
  now.objects[7].T_sensor_object = poseFromYpr(5, 5, 0, 0.3, 0, 0);
  then.objects[7].T_sensor_object = poseFromYpr(4, 4, 0, 0.3, 0, 0);
  const auto s = dyslam::makeSample(clip, 1, 0);
  EXPECT_EQ(s.label[0], DysegSample::static_point);
  EXPECT_EQ(s.label[1], DysegSample::moving_point);
  EXPECT_EQ(s.label[2], DysegSample::ignored_point);
  EXPECT_NEAR(s.flow[0].x(), 1 + 10 * std::cos(0.1) - 10, 1e-5);
  EXPECT_NEAR(s.flow[0].y(), 10 * std::sin(0.1), 1e-5);
  EXPECT_NEAR(s.flow[1].x(), -1, 1e-5);
  EXPECT_NEAR(s.flow[1].y(), -1, 1e-5);
  EXPECT_FALSE(s.flow[2].allFinite());
  EXPECT_EQ(s.movers.size(), 1U);
}

/** A clip of two frames: the sensor moves by 1 m, an object by `displacement` over ground. In the
 * earlier frame the object is 1 m + `displacement` farther away. */
dyslam::DysegClip clipOf(bool moving, float displacement, std::size_t points)
{
  dyslam::DysegClip clip;
  clip.frames.resize(2);
  auto& now = clip.frames[1];
  now.T_world_sensor = poseFromYpr(1, 0, 0, 0, 0, 0);
  now.points.assign(points, {10, 0, 0});
  now.object.assign(points, 7);
  now.objects[7].moving = moving;
  now.objects[7].T_sensor_object = poseFromYpr(10, 0, 0, 0, 0, 0);
  clip.frames[0].objects[7].T_sensor_object = poseFromYpr(11 + displacement, 0, 0, 0, 0, 0);
  return clip;
}

TEST(DysegSample, LabelsAreThoseThatThePairShows)
{
  struct Case
  {
    bool moving;
    float displacement;
    std::uint8_t label;
    float flow;
  };
  for (const Case& c : {Case{true, 0.5F, DysegSample::moving_point, 1.5F},
                        Case{true, 0.05F, DysegSample::ignored_point, 1.05F},
                        Case{false, 0.5F, DysegSample::ignored_point, 1.5F},
                        Case{false, 0.15F, DysegSample::static_point, 1.15F},
                        Case{false, 0.02F, DysegSample::static_point, 1}})
  {
    const auto s = dyslam::makeSample(clipOf(c.moving, c.displacement, 1), 1, 0);
    EXPECT_EQ(s.label[0], c.label) << c.moving << " " << c.displacement;
    EXPECT_NEAR(s.flow[0].x(), c.flow, 1e-5) << c.moving << " " << c.displacement;
  }
  for (const bool moving : {false, true})
  {
    auto clip = clipOf(moving, 0, 1);
    clip.frames[0].objects.clear();
    const auto s = dyslam::makeSample(clip, 1, 0);
    EXPECT_EQ(s.label[0], moving ? DysegSample::moving_point : DysegSample::static_point);
    EXPECT_EQ(s.flow[0].allFinite(), !moving) << "where a moving object was is not known";
  }
}

TEST(DysegSample, LabelsBySpeedDoNotDependOnAnotherFrame)
{
  auto frame = clipOf(true, 0, 1).frames[1];
  frame.objects[8].doubtful = true;
  frame.objects[9];
  frame.object = {7, 8, 9, 10, dyslam::DysegClip::still, dyslam::DysegClip::unknown};
  EXPECT_EQ(dyslam::labelsBySpeed(frame),
            (std::vector<std::uint8_t>{DysegSample::moving_point, DysegSample::ignored_point,
                                       DysegSample::static_point, DysegSample::ignored_point,
                                       DysegSample::static_point, DysegSample::ignored_point}));
}

TEST(DysegSample, OnlyObjectsWithPointsAreForCrops)
{
  const auto movers = [](const dyslam::DysegClip& clip)
  { return dyslam::makeSample(clip, 1, 0).movers.size(); };
  EXPECT_EQ(movers(clipOf(true, 0.5F, dyslam::min_mover_points)), 1U);
  EXPECT_EQ(movers(clipOf(true, 0.5F, dyslam::min_mover_points - 1)), 0U);
  EXPECT_EQ(movers(clipOf(true, 0.5F, 0)), 0U);
  EXPECT_EQ(movers(clipOf(true, 0.05F, dyslam::min_mover_points)), 0U) << "does not show it";
  EXPECT_EQ(movers(clipOf(false, 0.5F, dyslam::min_mover_points)), 0U);
}

TEST(DysegSample, CastBodiesWhoseMotionThePairDoesNotShowAreIgnored)
{
  dyslam::DysegAugmentOptions options;
  options.moving_share = 1;
  options.convoy_share = 0;
  std::ptrdiff_t ignored = 0;
  for (std::uint64_t k = 0; k < 10; ++k)
  {
    RandomDraws draws(8, k);
    auto s = dyslam::doubleScan(room(), Pose::Identity(), draws);
    s.elapsed = 0.005;  // the fastest body moves by 0.09 m
    dyslam::augment(options, draws, s);
    EXPECT_EQ(std::count(s.label.begin(), s.label.end(), DysegSample::moving_point), 0);
    EXPECT_TRUE(s.movers.empty());
    ignored += std::count(s.label.begin(), s.label.end(), DysegSample::ignored_point);
  }
  EXPECT_GT(ignored, 100);
}

TEST(DysegSample, AugmentingKeepsFlowAndMotionInStep)
{
  for (std::uint64_t k = 0; k < 5; ++k)
  {
    RandomDraws draws(3, k);
    auto s = dyslam::doubleScan(room(), poseFromYpr(0.8, 0.1, 0, 0.02, 0, 0), draws);
    dyslam::augment(dyslam::DysegAugmentOptions(), draws, s);
    ASSERT_EQ(s.label.size(), s.current.size());
    ASSERT_EQ(s.flow.size(), s.current.size());
    EXPECT_NEAR(s.T_past_current.linear().determinant(), 1, 1e-9);
    std::size_t checked = 0;
    for (std::size_t i = 0; i < s.current.size(); ++i)
    {
      if (s.label[i] != DysegSample::static_point || s.current[i].isZero())
      {
        continue;
      }
      const Eigen::Vector3d to = s.T_past_current * s.current[i].cast<double>();
      EXPECT_LT((to.head<2>().cast<float>() - s.current[i].head<2>() - s.flow[i]).norm(), 1e-3);
      ++checked;
    }
    EXPECT_GT(checked, 10000U);
  }
}

/** A boxed run of one frame without any point. */
class BoxedRun : public ::testing::Test
{
 protected:
  BoxedRun()
  {
    std::filesystem::create_directories(folder_ + "/velodyne");
    std::filesystem::create_directories(folder_ + "/label_json");
    dyslam::writeWhole(folder_ + "/velodyne/000000.bin", "");
    setBox("1.5");
    dyslam::writeWhole(folder_ + "/poses_icp_frame_to_frame.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  }
  ~BoxedRun() override { std::filesystem::remove_all(folder_); }

  void setBox(const std::string& x) const
  {
    const std::string rest = ", \"y\": 2, \"z\": 0}";
    dyslam::writeWhole(
        folder_ + "/label_json/000000.json",
        "[{\"obj_id\": \"3\", \"obj_type\": \"Car\", \"psr\": {\"position\": {\"x\": " + x + rest +
            ", \"rotation\": {\"x\": 0" + rest + ", \"scale\": {\"x\": 4" + rest + "}}]");
  }
  [[nodiscard]] dyslam::DysegClip load() const { return dyslam::loadBoxedRun(folder_, 0, 0, {}); }

  std::string folder_ = ::testing::TempDir() + "dyslam_boxed_run";
};

TEST_F(BoxedRun, BoxesWithoutNumbersAreAClearError)
{
  EXPECT_NEAR(load().frames[0].objects.at(3).T_sensor_object.translation().x(), 1.5, 1e-9);
  for (const char* x : {"wide", "", "1e999"})
  {
    setBox(x);
    EXPECT_THROW((void)load(), dyslam::UserError) << x;
  }
  dyslam::writeWhole(folder_ + "/label_json/000000.json", "[{\"obj_id\":");
  EXPECT_THROW((void)load(), dyslam::UserError);
}

/** Without an id, or with 0, which means no object, a box belongs to no track. */
TEST_F(BoxedRun, PointsInBoxesOfNoTrackAreIgnored)
{
  const std::vector<float> point{1.5F, 2, 0, 0.5F};
  dyslam::writeWhole(folder_ + "/velodyne/000000.bin",
                     {reinterpret_cast<const char*>(point.data()), 4 * sizeof(float)});
  const std::string labels = folder_ + "/label_json/000000.json";
  const std::string given = dyslam::readWhole(labels);
  EXPECT_EQ(load().frames[0].object, std::vector<std::int32_t>{3});
  for (const char* id : {"0", ""})
  {
    std::string text = given;
    dyslam::writeWhole(labels, text.replace(text.find("\"3\""), 3, std::string("\"") + id + "\""));
    const auto frame = load().frames[0];
    EXPECT_TRUE(frame.objects.empty()) << id;
    EXPECT_EQ(dyslam::labelsBySpeed(frame),
              std::vector<std::uint8_t>{dyslam::DysegSample::ignored_point})
        << id;
  }
}

TEST_F(BoxedRun, MalformedPosesAndTruncatedScansAreRefused)
{
  const std::string pose = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::string poses = folder_ + "/poses_icp_frame_to_frame.txt";
  dyslam::writeWhole(poses, pose + "\n" + pose);
  EXPECT_EQ(load().frames.size(), 1U) << "a blank line is none";
  for (const char* line : {"nothing", "1 0 0 0 0 1 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 7"})
  {
    // If the line were skipped, the following frames would get the poses of others.
    dyslam::writeWhole(poses, line + ("\n" + pose));
    EXPECT_THROW((void)load(), dyslam::UserError) << line;
  }
  dyslam::writeWhole(poses, pose);
  dyslam::writeWhole(folder_ + "/velodyne/000000.bin", std::string(20, '\0'));
  EXPECT_THROW((void)load(), dyslam::UserError);
}

/** A sensor that passes a post and a parked car at 1 m per revolution; its scans are of one
 * revolution each and 1.25 revolutions apart. */
class DriftingRun : public ::testing::Test
{
 protected:
  static constexpr int frames = 9;
  static constexpr double per_revolution = 1;  // distance driven per revolution [m]

  DriftingRun()
  {
    std::filesystem::create_directories(folder_ + "/velodyne");
    std::filesystem::create_directories(folder_ + "/label_json");
    std::string poses;
    for (int f = 0; f < frames; ++f)
    {
      poses += "1 0 0 " + std::to_string(f * per_revolution) + " 0 1 0 0 0 0 1 0\n";
      const Eigen::Vector2d post = seen({20, 6}, f);
      const Eigen::Vector2d car = seen({15, -7}, f);
      const std::vector<float> point{static_cast<float>(post.x()), static_cast<float>(post.y()), 0,
                                     0.5F};
      dyslam::writeWhole(name("velodyne", f, ".bin"),
                         {reinterpret_cast<const char*>(point.data()), 4 * sizeof(float)});
      const auto xyz = [](double x, double y, double z)
      {
        return "{\"x\": " + std::to_string(x) + ", \"y\": " + std::to_string(y) +
               ", \"z\": " + std::to_string(z) + "}";
      };
      dyslam::writeWhole(name("label_json", f, ".json"),
                         "[{\"obj_id\": \"3\", \"obj_type\": \"Car\", \"psr\": {\"position\": " +
                             xyz(car.x(), car.y(), 0) + ", \"rotation\": " + xyz(0, 0, 0) +
                             ", \"scale\": " + xyz(4, 2, 1.5) + "}}]");
    }
    dyslam::writeWhole(folder_ + "/poses_icp_frame_to_frame.txt", poses);
  }
  ~DriftingRun() override { std::filesystem::remove_all(folder_); }

  static dyslam::BoxedRunOptions optionsWith(const dyslam::SweepDrift& drift)
  {
    dyslam::BoxedRunOptions options;
    options.drift = drift;
    return options;
  }

  [[nodiscard]] std::string name(const std::string& part, int frame, const char* ext) const
  {
    return folder_ + "/" + part + "/00000" + std::to_string(frame) + ext;
  }

  /** Measured position of an object at rest in a scan, at the time at which the sweep passed it. */
  Eigen::Vector2d seen(const Eigen::Vector2d& world, int frame) const
  {
    Eigen::Vector2d p = world;
    for (int i = 0; i < 20; ++i)  // fixed point: direction and time depend on each other
    {
      const double begin = drift_.start_azimuth + frame * drift_.step;
      const double turned = begin - std::atan2(p.y(), p.x());
      const double fraction = turned / (2 * M_PI) - std::floor(turned / (2 * M_PI));
      const double at = frame * drift_.revolutions() + fraction - 0.5;
      p = world - Eigen::Vector2d(at * per_revolution, 0);
    }
    return p;
  }

  dyslam::SweepDrift drift_{0.3, -0.5 * M_PI};
  dyslam::BoxedRunOptions options_ = optionsWith(drift_);
  std::string folder_ = ::testing::TempDir() + "dyslam_drifting_run";
};

TEST_F(DriftingRun, WhatStandsStaysInItsPlace)
{
  const auto clip = dyslam::loadBoxedRun(folder_, 0, frames - 1, options_);
  for (const auto& frame : clip.frames)
  {
    const Eigen::Vector3d post = frame.T_world_sensor * frame.points[0].cast<double>();
    EXPECT_LT((post.head<2>() - Eigen::Vector2d(20, 6)).norm(), 0.01);
    const auto& car = frame.objects.at(3);
    const Eigen::Vector3d at = (frame.T_world_sensor * car.T_sensor_object).translation();
    EXPECT_LT((at.head<2>() - Eigen::Vector2d(15, -7)).norm(), 0.01);
    EXPECT_FALSE(car.moving);
  }
  EXPECT_NEAR(clip.frames[8].T_world_sensor.translation().x(), 10, 1e-9) << "8 x 1.25 revolutions";
  EXPECT_NEAR(clip.period, 1.25 * 0.091, 1e-9);
}

TEST_F(DriftingRun, RevolutionAndStandingObjectsAreOfTheRecording)
{
  options_.revolution = 0.05;
  options_.standing_first = options_.standing_last = 3;
  const auto clip = dyslam::loadBoxedRun(folder_, 0, frames - 1, options_);
  EXPECT_NEAR(clip.period, 1.25 * 0.05, 1e-9);
  EXPECT_TRUE(clip.frames[0].objects.empty());
  options_.standing_last = 2;
  EXPECT_EQ(dyslam::loadBoxedRun(folder_, 0, 0, options_).frames[0].objects.count(3), 1U);
}

TEST_F(DriftingRun, OtherwiseItJumps)
{
  const auto clip = dyslam::loadBoxedRun(folder_, 0, frames - 1, {});
  double farthest = 0;
  for (const auto& frame : clip.frames)
  {
    const Eigen::Vector3d post = frame.T_world_sensor * frame.points[0].cast<double>();
    farthest = std::max(farthest, (post.head<2>() - Eigen::Vector2d(20, 6)).norm());
  }
  EXPECT_GT(farthest, 1.5);
}

/** The motions of labelled objects are not known: no object has an earlier position. */
TEST(LabelledRun, ObjectsOfEachFrameHaveIdsOfTheirOwn)
{
  const std::string folder = ::testing::TempDir() + "dyslam_labelled_run";
  std::filesystem::create_directories(folder + "/velodyne");
  std::filesystem::create_directories(folder + "/labels");
  constexpr std::size_t first = 30000;
  std::string poses;
  for (std::size_t i = 0; i < first + 2; ++i)
  {
    poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  }
  dyslam::writeWhole(folder + "/poses.txt", poses);
  const std::vector<float> points{10, 0, 0, 0.5F, 0, 10, 0, 0.5F};
  const std::vector<std::uint32_t> labels{(3U << 16U) | 252U, 40U};
  const auto bytesOf = [](const auto& values)
  {
    return std::string_view(reinterpret_cast<const char*>(values.data()),
                            values.size() * sizeof(values[0]));
  };
  for (const char* frame : {"030000", "030001"})
  {
    dyslam::writeWhole(folder + "/velodyne/" + frame + ".bin", bytesOf(points));
    dyslam::writeWhole(folder + "/labels/" + frame + ".label", bytesOf(labels));
  }
  const auto clip = dyslam::loadLabelledRun(folder, folder + "/poses.txt", first, first + 1);
  std::filesystem::remove_all(folder);
  ASSERT_EQ(clip.frames.size(), 2U);
  for (const auto& frame : clip.frames)
  {
    EXPECT_GT(frame.object[0], 0);
    EXPECT_EQ(frame.object[1], dyslam::DysegClip::still);
    ASSERT_EQ(frame.objects.count(frame.object[0]), 1U);
    EXPECT_TRUE(frame.objects.at(frame.object[0]).moving);
  }
  EXPECT_NE(clip.frames[0].object[0], clip.frames[1].object[0]);
  const auto sample = dyslam::makeSample(clip, 1, 0);
  EXPECT_EQ(sample.label[0], DysegSample::moving_point);
  EXPECT_FALSE(sample.flow[0].allFinite());
}

TEST(SimulateClip, SeedsBeyondTheLargestAreRefused)
{
  EXPECT_THROW((void)dyslam::simulateClip(2147483648U, 1, true), dyslam::UserError);
}

TEST(SimulateClip, FewerColumnsGiveFewerPoints)
{
  dyslam::DysegClipScene scene;
  scene.sensor = dyslam::sim::SensorKind::vlp16;
  const auto full = dyslam::simulateClip(dyslam::unseen_seeds, 1, true, scene);
  scene.columns = 904;
  const auto half = dyslam::simulateClip(dyslam::unseen_seeds, 1, true, scene);
  const auto points = [](const dyslam::DysegClip& clip)
  { return static_cast<double>(clip.frames[0].points.size()); };
  EXPECT_NEAR(points(half) / points(full), 0.5, 0.05);
}

TEST(SimulateClip, StandingBodiesKeepTheirIds)
{
  dyslam::DysegClipScene scene;
  scene.traffic = 1;
  scene.columns = 400;
  std::size_t standing = 0;
  for (std::uint64_t i = 0; i < 3; ++i)
  {
    const auto clip = dyslam::simulateClip(dyslam::unseen_seeds + i, 1, true, scene);
    const auto& frame = clip.frames[0];
    for (const std::int32_t id : frame.object)
    {
      if (id > 0)
      {
        const auto& object = frame.objects.at(id);
        standing += object.moving || object.doubtful ? 0 : 1;
      }
    }
  }
  EXPECT_GT(standing, 50U);
}

TEST(DysegSample, SameNumberSameSample)
{
  const auto make = []
  {
    RandomDraws draws(4, 9);
    auto s = dyslam::doubleScan(room(), Pose::Identity(), draws);
    dyslam::augment(dyslam::DysegAugmentOptions(), draws, s);
    return s;
  };
  const auto a = make();
  const auto b = make();
  EXPECT_EQ(a.current, b.current);
  EXPECT_EQ(a.past, b.past);
  EXPECT_EQ(a.label, b.label);
}
}  // namespace
