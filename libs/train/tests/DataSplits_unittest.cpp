// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/train/DataSplits.h>
#include <dyslam/train/DataText.h>
#include <dyslam/train/TrainDylo.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

std::string errorOf(const std::function<void()>& call)
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

std::string wordsOf(const std::string& text)
{
  return errorOf([&] { DataSplits(Config::fromText(text, "my splits")); });
}

void expectHas(const std::string& text, const std::string& part)
{
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(DataSplits, AFrameIsOfTheSplitOfItsRangeAndRecording)
{
  const DataSplits splits(Config::fromText(
      "[drive]\ntraining = 0-4, 9\nvalidation = 5-8\ntest = 20-\n[other]\ntest = 0-\n", "mine"));
  EXPECT_NO_THROW(splits.requireScan("/a/drive/velodyne/000004.bin", Split::training, "here"));
  EXPECT_NO_THROW(splits.requireScan("/a/drive/9.bin", Split::training, "here"));
  EXPECT_NO_THROW(splits.requireScan("/a/drive/run2_000005.bin", Split::validation, "here"));
  EXPECT_NO_THROW(splits.requireScan("/other/drive/99.bin", Split::test, "here"));
  const auto said = [&](const std::string& file)
  { return errorOf([&] { splits.requireScan(file, Split::training, "here"); }); };
  expectHas(said("/a/drive/000005.bin"), "frame 5 of drive is for validation, not for training");
  expectHas(said("/a/drive/000020.bin"), "frame 20 of drive is for test, not for training");
  expectHas(said("/a/drive/000010.bin"), "frame 10 of drive is in no split");
  expectHas(said("/drive/other/000000.bin"), "frame 0 of other is for test");
  expectHas(said("/a/unknown/000000.bin"), "none of its folders is a section");
  expectHas(said("/a/drive/scan.bin"), "no frame number");
}

TEST(DataSplits, AnotherNameOfAFolderChangesNothing)
{
  const fs::path folder = fs::path(testing::TempDir()) / "splits_link";
  fs::remove_all(folder);
  fs::create_directories(folder / "drive");
  fs::create_directory_symlink(folder / "drive", folder / "training");
  const DataSplits splits(
      Config::fromText("[drive]\ntest = 0-\n[training]\ntraining = 0-\n", "mine"));
  EXPECT_THROW(
      splits.requireScan((folder / "training" / "0.bin").string(), Split::training, "here"),
      UserError);
}

TEST(DataSplits, MistakesInTheFileAreNamed)
{
  expectHas(wordsOf("[drive]\ntraining = 0-4\ntest = 4-8\n"), "of [drive] overlaps another range");
  expectHas(wordsOf("[drive]\ntrain = 0-4\n"), "'train' is no split");
  expectHas(wordsOf("[drive]\ntest = 8-4\n"), "'8-4' is not a range");
  expectHas(wordsOf("[drive]\ntest = all\n"), "'all' is not a range");
}

TEST(DataSplits, AScanHasOneSplitOrNone)
{
  const DataSplits splits(Config::fromText("[drive]\ntraining = 0-4\ntest = 20-\n", "mine"));
  EXPECT_EQ(splits.splitOfScan("/a/drive/velodyne/000004.bin"), Split::training);
  EXPECT_EQ(splits.splitOfScan("/a/drive/velodyne/000021.bin"), Split::test);
  for (const char* file : {"/a/drive/000005.bin", "/a/drive/scan.bin", "/a/other/000000.bin"})
  {
    EXPECT_EQ(splits.splitOfScan(file), std::nullopt) << file;
  }
}

TEST(DataSplits, ASeedHasOneSplitOrNone)
{
  const DataSplits splits(
      Config::fromText("[simulator]\ntraining = 5-9\nvalidation = 0-4, 20\ntest = 30-\n", "mine"));
  EXPECT_EQ(splits.splitOfSeed(9), Split::training);
  EXPECT_EQ(splits.splitOfSeed(20), Split::validation);
  EXPECT_EQ(splits.splitOfSeed(31), Split::test);
  EXPECT_EQ(splits.splitOfSeed(10), std::nullopt);
  EXPECT_EQ(DataSplits(Config()).splitOfSeed(1), std::nullopt);
}

TEST(DataSplits, TheShippedFileKeepsWhatWasChosenByOutOfTrainingAndTest)
{
  const DataSplits splits = DataSplits::load("splits", "here");
  for (const int seed : {21, 31, 101, 102, 103, 104, 407, 546, 2104, 9005, 9305})
  {
    EXPECT_NO_THROW(splits.requireSeed(seed, Split::validation, "here"));
  }
  EXPECT_NO_THROW(splits.requireSeed(1200000000, Split::test, "here"));
  const NumberRange seeds = splits.trainingSeeds();
  EXPECT_NO_THROW(splits.requireSeed(seeds.first, Split::training, "here"));
  EXPECT_NO_THROW(splits.requireSeed(seeds.last, Split::training, "here"));
  EXPECT_THROW(splits.requireSeed(seeds.last + 1, Split::training, "here"), UserError);
  const std::string drive = "/d/kitti_raw_2011_09_26_drive_0005/velodyne/";
  EXPECT_NO_THROW(splits.requireScan(drive + "000079.bin", Split::training, "here"));
  EXPECT_NO_THROW(splits.requireScan(drive + "000109.bin", Split::validation, "here"));
  EXPECT_NO_THROW(splits.requireScan(drive + "000110.bin", Split::test, "here"));
  EXPECT_NO_THROW(
      splits.requireScan("/d/sfnd_lidar_data_1/velodyne/000006.bin", Split::validation, "here"));
  EXPECT_NO_THROW(
      splits.requireScan("/d/vls128_run88/velodyne/000048.bin", Split::validation, "h"));
  EXPECT_NO_THROW(
      splits.requireScan("/d/semantickitti_08_labelled_2frames/001500.bin", Split::test, "here"));
}

/** Error message of a DyLO training with one more setting. */
std::string errorOf(const std::string& key, const std::string& value)
{
  const fs::path data = fs::path(testing::TempDir()) / "splits_data";
  const fs::path drive = data / "kitti_raw_2011_09_26_drive_0005";
  fs::remove_all(data);
  fs::create_directories(drive / "velodyne");
  for (const char* name : {"000079.bin", "000080.bin"})
  {
    std::ofstream(drive / "velodyne" / name);
  }
  Config config = Config::fromText("[train]\nsteps = 1\n[network]\nwidth = 0.125\n", "test");
  config.set("data.base=" + data.string());
  config.set("data." + key + "=" + value);
  DyloTrainRequest request;
  request.output = (data / "out").string();
  request.report = [](const std::string&) {};
  return errorOf([&] { trainDylo(config, request); });
}

TEST(DataSplits, DyloTrainsAndValidatesOnNothingElse)
{
  const std::string drive = "kitti_raw_2011_09_26_drive_0005";
  const std::string both = drive + "/velodyne; none.txt; 0; 1";
  expectHas(errorOf("recordings", both), "frame 80 of " + drive + " is for validation");
  expectHas(errorOf("validation", both), "frame 79 of " + drive + " is for training");
  expectHas(errorOf("singles", drive + "/velodyne"), "frame 80 of " + drive + " is for validation");
  expectHas(errorOf("bodies", drive + "/velodyne"), "frame 80 of " + drive + " is for validation");
  expectHas(errorOf("simulated_validation", "urban;VLP16;0;1200000001;2"),
            "seed 1200000001 of the simulator is for test, not for validation");
  expectHas(errorOf("simulated_validation", "urban;VLP16;0;500000001;2"), "is for training");
}

TEST(DataSplits, ErrorsInSimulatedDriveNameTheirItem)
{
  const std::string validation = "[data] simulated_validation: 'urban;VLP16;";
  expectHas(errorOf("simulated_validation", "urban;VLP16;0;9001"),
            validation + "0;9001': write world;sensor;traffic;seed;scans");
  expectHas(errorOf("simulated_validation", "urban;VLP16;1.5;9001;2"),
            validation + "1.5;9001;2': [simulator] traffic = 1.5 is out of range; use 0 to 1");
  expectHas(errorOf("simulated_validation", "urbn;VLP16;0;9001;2"),
            "[data] simulated_validation: 'urbn;VLP16;0;9001;2': unknown world 'urbn'");
}
}  // namespace
}  // namespace dyslam
