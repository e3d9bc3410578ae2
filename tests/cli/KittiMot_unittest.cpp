// SPDX-License-Identifier: BSD-3-Clause
// dyslam-eval kitti-mot and speeds on a small synthetic folder in KITTI's layout.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "KittiScene.h"
#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

Outcome kittiMot(const TestFolder& folder, const std::string& arguments)
{
  return runProgram("dyslam-eval", "kitti-mot --repeats 1 --class Car " + arguments, folder.path());
}
}  // namespace

TEST(KittiMotProgram, WrittenTracksReplaceNoInput)
{
  const TestFolder folder;
  writeKittiScene(folder.path());
  const std::string before = folder.read("det_pointrcnn/0000.txt");
  for (const char* input : {"det_pointrcnn", "label_02"})
  {
    const Outcome outcome = kittiMot(
        folder, "--sequences 0000 --data " + folder.path() + " --tracks " + folder.file(input));
    EXPECT_EQ(outcome.code, 1);
    EXPECT_TRUE(contains(outcome.err, ": has the files that are read; choose another"))
        << outcome.err;
  }
  EXPECT_EQ(before, folder.read("det_pointrcnn/0000.txt"));
}

TEST(KittiMotProgram, PublishedFiguresAreOfPointRcnnsDetectionsOnly)
{
  const TestFolder folder;
  writeKittiScene(folder.path());
  const fs::path all = folder.file("validation");
  for (const std::string name :
       {"0001", "0006", "0008", "0010", "0012", "0013", "0014", "0015", "0016", "0018", "0019"})
  {
    for (const char* sub : {"calib", "oxts", "label_02", "det_pointrcnn"})
    {
      fs::create_directories(all / sub);
      fs::copy_file(fs::path(folder.path()) / sub / "0000.txt", all / sub / (name + ".txt"));
    }
  }
  const std::string data = "--data " + all.string();
  const Outcome own = kittiMot(folder, data + " --tracks " + folder.file("tracks"));
  ASSERT_EQ(own.code, 0) << own.err;
  EXPECT_TRUE(contains(own.out, "AB3DMOT, published")) << own.out;
  EXPECT_TRUE(fs::exists(folder.file("tracks/0019.txt")));
  const Outcome given =
      kittiMot(folder, data + " --detections " + (all / "det_pointrcnn").string());
  ASSERT_EQ(given.code, 0) << given.err;
  EXPECT_FALSE(contains(given.out, "AB3DMOT")) << given.out;
}

TEST(KittiMotProgram, OptionsWithoutAnEffectAreErrors)
{
  const TestFolder folder;
  writeKittiScene(folder.path());
  const std::string data = "--data " + folder.path();
  const Outcome seed = kittiMot(folder, data + " --sequences 0000 --seed 2");
  EXPECT_EQ(seed.code, 1);
  EXPECT_TRUE(contains(seed.err, "--seed requires --noise")) << seed.err;
  const Outcome split = kittiMot(folder, data + " --sequences 0000 --split training");
  EXPECT_EQ(split.code, 1);
  EXPECT_TRUE(contains(split.err, "excludes")) << split.err;
}

TEST(KittiMotProgram, SpeedsAreInATable)
{
  const TestFolder folder;
  writeKittiScene(folder.path());
  fs::create_directories(folder.file("det_pointrcnn/Car"));
  fs::copy_file(folder.file("det_pointrcnn/0000.txt"), folder.file("det_pointrcnn/Car/0000.txt"));
  const std::string series = folder.write("series.csv", "time,speed\n1.036,3\n2.072,3\n");
  const std::string speeds = "speeds --sequence 0000 --track 1 --data " + folder.path();
  const Outcome table =
      runProgram("dyslam-eval", speeds + " --series given=" + series, folder.path());
  ASSERT_EQ(table.code, 0) << table.err;
  EXPECT_TRUE(contains(table.out, "sequence 0000, track 1")) << table.out;
  EXPECT_TRUE(contains(table.out, "given")) << table.out;
  const Outcome unnamed = runProgram("dyslam-eval", speeds + " --series " + series, folder.path());
  EXPECT_EQ(unnamed.code, 1);
  EXPECT_TRUE(contains(unnamed.err, "must be NAME=FILE.csv")) << unnamed.err;
}

TEST(KittiMotProgram, PredictionOfThePapersTargetsHasNoOwnTarget)
{
  const TestFolder folder;
  const Outcome outcome =
      runProgram("dyslam-eval", "prediction --track 1 --data " + folder.path(), folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(contains(outcome.err, "excludes")) << outcome.err;
}
}  // namespace dyslam
