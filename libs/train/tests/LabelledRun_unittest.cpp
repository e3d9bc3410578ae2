// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/train/LabelledRun.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <thread>

#include "DysegPairs.h"
#include "DysegValidation.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr std::size_t house_points = 40;  // at rest
constexpr std::size_t car_points = 20;    // moving, instance 3
constexpr std::size_t other_points = 3;   // unlabelled, outlier, moving person without instance

/** Two sequences in SemanticKITTI's layout, with poses of the camera, and a file of splits. */
class SemanticKitti : public ::testing::Test
{
 protected:
  SemanticKitti()
  {
    T_cam_velo_ = cameraAxes();
    T_cam_velo_.translation() = Eigen::Vector3d(0.1, -0.05, -0.3);
    writeSequence("00", 12);
    writeSequence("01", 4);
    writeWhole(folder_ + "/splits.ini",
               "[00]\ntraining = 0-9\nvalidation = 10-\n[01]\ntraining = 0-\n[simulator]\n"
               "training = 500000000-899999999\n"
               "validation = 900000000-900999999\n");
  }
  ~SemanticKitti() override { fs::remove_all(folder_); }

  static Pose poseOf(std::size_t frame)
  {
    const auto f = static_cast<double>(frame);
    return poseFromYpr(1.5 * f, 0.02 * f * f, 0, 0.03 * f, 0, 0);
  }

  /** Points of the house in the world, then of the car 2 m further in each frame, then others. */
  static std::vector<Eigen::Vector3d> world(std::size_t frame)
  {
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < house_points; ++i)
    {
      points.emplace_back(25, -10 + 0.5 * static_cast<double>(i), 0.5);
    }
    for (std::size_t i = 0; i < car_points; ++i)
    {
      points.emplace_back(8 + 2 * static_cast<double>(frame), 4 + 0.1 * static_cast<double>(i), -1);
    }
    points.emplace_back(5, -5, 0);
    points.emplace_back(5, -6, 0);
    points.emplace_back(5, -7, 0);
    return points;
  }

  void writeSequence(const std::string& name, std::size_t frames)
  {
    const std::string sequence = folder_ + "/sequences/" + name;
    fs::create_directories(sequence + "/velodyne");
    fs::create_directories(sequence + "/labels");
    std::vector<Label> labels(house_points, makeLabel(50, 0));
    labels.resize(house_points + car_points, makeLabel(252, 3));
    labels.insert(labels.end(), {0, 1, makeLabel(254, 0)});
    std::vector<Pose> poses;
    for (std::size_t f = 0; f < frames; ++f)
    {
      std::vector<Eigen::Vector3f> points;
      for (const Eigen::Vector3d& p : world(f))
      {
        points.emplace_back((poseOf(f).inverse() * p).cast<float>());
      }
      writeBin(numberedPath(sequence + "/velodyne", f, ".bin"), points);
      writeLabels(numberedPath(sequence + "/labels", f, ".label"), labels);
      poses.push_back(poseOf(f));
    }
    writeKittiPoses(sequence + "/poses.txt", posesOfMountedSensor(poses, T_cam_velo_.inverse()));
    std::string row;
    for (int i = 0; i < 12; ++i)
    {
      row += " " + std::to_string(T_cam_velo_.matrix()(i / 4, i % 4));
    }
    writeWhole(sequence + "/calib.txt", "Tr:" + row + "\n");
  }

  [[nodiscard]] static std::string runOf(const std::string& name, int first, int last)
  {
    return name + "/velodyne; " + name + "/poses.txt; " + std::to_string(first) + "; " +
           std::to_string(last) + "; calib=" + name + "/calib.txt";
  }

  [[nodiscard]] LabelledRun load(int first, int last) const
  {
    return {parseRecording(runOf("00", first, last), folder_ + "/sequences", "[train]"), 0.1};
  }

  [[nodiscard]] DysegTrainerOptions optionsFor(const std::string& labelled_runs) const
  {
    DysegTrainerOptions options;
    options.data = folder_ + "/sequences";
    options.splits = folder_ + "/splits.ini";
    options.boxed_run.clear();
    options.single_scans.clear();
    options.simulated_share = 0;
    options.labelled_runs = labelled_runs;
    return options;
  }

  /** Validation on the last frame of sequence 00 alone. */
  [[nodiscard]] DysegTrainerOptions optionsForValidation() const
  {
    DysegTrainerOptions options = optionsFor("");
    options.boxed_validation.clear();
    options.labelled_validation = "00";
    options.labelled_poses = "poses.txt";
    options.labelled_calib = "calib.txt";
    options.labelled_validation_first = options.labelled_validation_last = 11;
    return options;
  }

  static std::string messageOf(const std::function<void()>& call)
  {
    try
    {
      call();
    }
    catch (const UserError& e)
    {
      return e.what();
    }
    return "";
  }

  Pose T_cam_velo_ = Pose::Identity();
  std::string folder_ = ::testing::TempDir() + "dyslam_semantic_kitti";
};

TEST_F(SemanticKitti, PairsHaveTheLabelsAndTheFlowOfTheStatic)
{
  const LabelledRun run = load(1, 9);
  ASSERT_EQ(run.size(), 9U);
  for (const auto& [current, past] : {std::pair<std::size_t, std::size_t>{5, 2}, {0, 8}})
  {
    const DysegSample pair = run.sample(current, past);
    ASSERT_EQ(pair.current.size(), house_points + car_points + other_points);
    EXPECT_NEAR(pair.elapsed, current == 5 ? 0.3 : 0.8, 1e-9);
    const Pose truth = poseOf(past + 1).inverse() * poseOf(current + 1);
    EXPECT_TRUE(pair.T_past_current.isApprox(truth, 1e-4));
    for (std::size_t i = 0; i < house_points; ++i)
    {
      EXPECT_EQ(pair.label[i], DysegSample::static_point);
      const Eigen::Vector2f moved = (pair.past[i] - pair.current[i]).head<2>();
      EXPECT_LT((pair.flow[i] - moved).norm(), 2e-3F) << "the same point in both scans";
    }
    for (std::size_t i = house_points; i < house_points + car_points; ++i)
    {
      EXPECT_EQ(pair.label[i], DysegSample::moving_point);
      EXPECT_FALSE(pair.flow[i].allFinite());
    }
    const std::size_t others = house_points + car_points;
    EXPECT_EQ(pair.label[others], DysegSample::ignored_point);
    EXPECT_EQ(pair.label[others + 1], DysegSample::ignored_point);
    EXPECT_EQ(pair.label[others + 2], DysegSample::moving_point);
    ASSERT_EQ(pair.movers.size(), 1U) << "a person of one point is too small for a crop";
    const auto on_car = pair.current.begin() + static_cast<std::ptrdiff_t>(house_points);
    EXPECT_TRUE(std::any_of(on_car, on_car + car_points,
                            [&](const Eigen::Vector3f& p)
                            { return p.head<2>() == pair.movers[0]; }));
  }
}

TEST_F(SemanticKitti, ScansAreDeskewedIfAsked)
{
  RecordingDescription description =
      parseRecording(runOf("00", 1, 9) + "; deskew", folder_ + "/sequences", "[train]");
  const LabelledRun deskewed(description, 0.1);
  const auto expected = deskewByAzimuth(load(1, 9).points(3), poseOf(3).inverse() * poseOf(4));
  const auto points = deskewed.points(3);
  ASSERT_EQ(points.size(), expected.size());
  float farthest = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    EXPECT_LT((points[i] - expected[i]).norm(), 1e-3F);
    farthest = std::max(farthest, (points[i] - load(1, 9).points(3)[i]).norm());
  }
  EXPECT_GT(farthest, 0.1F);
}

TEST_F(SemanticKitti, WhatIsMissingIsNamedBeforeTheTraining)
{
  const auto said = [&] { return messageOf([&] { (void)load(0, 9); }); };
  EXPECT_EQ(said(), "");
  const std::string sequence = folder_ + "/sequences/00";
  EXPECT_NE(messageOf([&] { (void)load(0, 12); }).find("poses.txt: has 12 poses, but frame 12"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { (void)load(3, 3); }).find("needs two scans or more"),
            std::string::npos);
  writeLabels(sequence + "/labels/000007.label", {1, 2});
  EXPECT_NE(said().find("000007.label: has 2 labels, but"), std::string::npos) << said();
  fs::remove(sequence + "/labels/000007.label");
  EXPECT_NE(said().find("000007.label: cannot be read"), std::string::npos) << said();
  fs::remove(sequence + "/velodyne/000004.bin");
  EXPECT_NE(said().find("velodyne: has no scan with number 4"), std::string::npos) << said();
}

TEST_F(SemanticKitti, ValidationLeavesOutNearReturns)
{
  DysegTrainerOptions options = optionsForValidation();
  options.validation_min_range = 10;  // the nearest points of the house are at 8.5 m
  const DysegSample pair = makeDysegValidation(options).back().samples.at(0);
  const DysegSample all = load(10, 11).sample(1, 0);
  ASSERT_EQ(pair.current.size(), all.current.size());
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < all.current.size(); ++i)
  {
    const bool near = all.current[i].norm() < 10;
    EXPECT_EQ(isReturn(pair.current[i]), !near) << i;
    left_out += near ? 1 : 0;
  }
  EXPECT_GT(left_out, 5U);
  EXPECT_LT(left_out, all.current.size() / 2);
}

TEST_F(SemanticKitti, ValidationIsDeskewedIfAsked)
{
  DysegTrainerOptions options = optionsForValidation();
  options.validation_min_range = 0;
  options.labelled_deskew = true;
  const auto recorded = load(10, 11).points(1);
  const auto expected = deskewByAzimuth(recorded, poseOf(10).inverse() * poseOf(11));
  EXPECT_GT((expected[0] - recorded[0]).norm(), 0.1F) << "beside the sensor";
  const DysegSample pair = makeDysegValidation(options).back().samples.at(0);
  ASSERT_EQ(pair.current.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
  {
    EXPECT_LT((pair.current[i] - expected[i]).norm(), 1e-3F) << i;
  }
}

TEST_F(SemanticKitti, FramesOfOtherSplitsAreRefused)
{
  const auto said = [&](const std::string& runs)
  { return messageOf([&] { const DysegPairs pairs(optionsFor(runs)); }); };
  EXPECT_EQ(said(runOf("00", 0, 9)), "");
  EXPECT_NE(
      said(runOf("00", 0, 10)).find("[train] labelled_runs: frame 10 of 00 is for validation"),
      std::string::npos);
  EXPECT_NE(said(runOf("02", 0, 3)).find("02/velodyne: no such folder"), std::string::npos);
  writeSequence("02", 4);
  EXPECT_NE(said(runOf("02", 0, 3)).find("none of its folders is a section of the file of splits"),
            std::string::npos);
  EXPECT_NE(
      said("00/velodyne").find("[train] labelled_runs: '00/velodyne': write folder;pose file"),
      std::string::npos);
  DysegTrainerOptions without_data = optionsFor(runOf("00", 0, 9));
  without_data.data.clear();
  EXPECT_NE(messageOf([&] { const DysegPairs pairs(without_data); }).find("[train] data is empty"),
            std::string::npos);
}

TEST_F(SemanticKitti, RunsAreDrawnByTheirScans)
{
  auto options = optionsFor(runOf("00", 0, 8) + " | " + runOf("01", 1, 3));
  options.same_scan_share = 0;
  options.gap_share = 1;  // 8 scans, which only the first run has
  options.labelled_period = 0.1;
  const DysegPairs pairs(options);
  EXPECT_EQ(pairs.summary(), "2 real runs (12 scans with point labels)");
  int of_first = 0;
  for (std::uint64_t i = 0; i < 400; ++i)
  {
    RandomDraws draws(1, i);
    of_first += pairs.draw(draws).elapsed > 0.7 ? 1 : 0;
  }
  EXPECT_NEAR(of_first, 300, 40);
}

/** The bytes of a pair; those of unknown flow are compared, too. */
std::string bytesOfPair(const DysegSample& pair)
{
  std::string bytes;
  const auto append = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  append(pair.current);
  append(pair.past);
  append(pair.label);
  append(pair.flow);
  return bytes;
}

TEST_F(SemanticKitti, SeveralThreadsDrawTheSamePairs)
{
  const DysegPairs pairs(optionsFor(runOf("00", 0, 9) + " | " + runOf("01", 0, 3)));
  constexpr std::size_t count = 40;
  const auto drawn = [&](std::size_t i)
  {
    RandomDraws draws(7, i);
    return bytesOfPair(pairs.draw(draws));
  };
  std::vector<std::string> expected;
  for (std::size_t i = 0; i < count; ++i)
  {
    expected.push_back(drawn(i));
  }
  std::vector<std::string> found(count);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
  {
    threads.emplace_back(
        [&, t]
        {
          for (std::size_t i = count - 1 - t; i < count; i -= 4)
          {
            found[i] = drawn(i);
          }
        });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_EQ(found, expected);
}
}  // namespace
}  // namespace dyslam
