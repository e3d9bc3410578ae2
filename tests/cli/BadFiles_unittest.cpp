// SPDX-License-Identifier: BSD-3-Clause
// Programs with trajectories, labels, run folders and scans that cannot be used.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "RefusedInput.h"
#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class BadFiles : public test::RefusedInput
{
};

TEST_F(BadFiles, Trajectories)
{
  const std::string good = write("good.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  const auto withPoses = [&](const std::string& content, const std::vector<std::string>& parts)
  {
    const std::string bad = write("bad.txt", content);
    expectRefusal("dyslam-eval", "trajectory --reference " + good + " --estimate " + bad, parts);
    expectRefusal("dyslam-map",
                  "-q -i " + at("good.rawlog") + " --trajectory " + bad + " -o " + at("never.pcd"),
                  parts);
  };
  withPoses("", {"bad.txt: holds no poses"});
  withPoses("1 2 3\n", {"bad.txt:1", "has 3 fields", "8 (TUM", "12 (KITTI)"});
  withPoses("1 nan 0 0 0 0 0 1\n", {"bad.txt:1", "'nan' is not a finite number"});
  withPoses("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", {"bad.txt:2"});
  withPoses("1 0 0 0 0 0 0 0\n", {"bad.txt:1"});
  expectRefusal("dyslam-eval", "trajectory --reference " + good + " --estimate " + at("none.txt"),
                {"none.txt: no such file"});
  const std::string later = write("later.txt", "7 0 0 0 0 0 0 1\n8 1 0 0 0 0 0 1\n");
  expectRefusal("dyslam-eval", "trajectory --reference " + good + " --estimate " + later,
                {"only 0 of 2 time stamps", "--tolerance 0.01 s",
                 "(7.000 to 8.000 s and 1.000 to 2.000 s; --time-offset"});
  EXPECT_EQ(
      run("dyslam-eval", "trajectory --time-offset -6 --reference " + good + " --estimate " + later)
          .code,
      0);
  expectRefusal("dyslam-map",
                "-q -i " + at("good.rawlog") + " --trajectory " + later + " -o " + at("never.pcd"),
                {"has no pose for any scan", "--tolerance"});
  EXPECT_FALSE(fs::exists(at("never.pcd")));
}

TEST_F(BadFiles, MapsOfPosesAndLabelsThatDoNotFit)
{
  std::string line = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::string three = write("three.txt", line + line + line);
  const std::string map = "-q -i " + at("good.rawlog") + " --trajectory " + three;
  const std::string output = " -o " + at("never.pcd");
  expectRefusal("dyslam-map", map + output,
                {"three.txt: has 3 poses", "12 scans are used", "--skip-first-n"});
  EXPECT_FALSE(fs::exists(at("never.pcd")));
  const std::string part = map + " --skip-first-n 4 --only-first-n 3 --keyframe-distance 0";
  const Outcome fits = run("dyslam-map", part + " -o " + at("part.pcd"));
  EXPECT_EQ(fits.code, 0) << fits.err;
  EXPECT_NE(fits.out.find("3 scans, 0 without a pose, 3 keyframes"), std::string::npos) << fits.out;

  fs::create_directories(at("no_labels"));
  expectRefusal("dyslam-map", part + output + " --labels " + at("no_labels"),
                {"no_labels: is not a folder of .label files"});
  write("other_labels/000000.label", "1234");
  expectRefusal("dyslam-map", part + output + " --labels " + at("other_labels"),
                {"000004.label: no such file", "--labels of this recording"});
  write("other_labels/000004.label", "1234");
  expectRefusal("dyslam-map", part + output + " --labels " + at("other_labels"),
                {"000004.label: has 1 label,"});
  expectRefusal("dyslam-map",
                part + " --labelled-map " + at("ref") + " --labels " + at("no_labels"),
                {"ref: the ending is none of .ply"});
  expectRefusal("dyslam-map", part + " --labelled-map " + at("ref.ply"),
                {"ref.ply", "give --labels or --tracks"});
  EXPECT_FALSE(fs::exists(at("never.pcd")));
}

TEST_F(BadFiles, FoldersOfRuns)
{
  expectRefusal("dyslam-eval", "run " + at("none"), {"none: is not a folder"});
  expectRefusal("dyslam-eval", "run " + at("file"), {"file: is not a folder"});
  fs::create_directories(at("bare"));
  expectRefusal("dyslam-eval", "run " + at("bare"), {"has no trajectory_tum.txt"});
  write("odd/trajectory_tum.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  write("odd/report.json", "{ \"frames\": ");
  expectRefusal("dyslam-eval", "run " + at("odd"), {"report.json: is not the JSON report"});
  // Reports of another program.
  write("odd/report.json", R"({"input": 4})");
  expectRefusal("dyslam-eval", "run " + at("odd"), {"report.json: ", "\"input\"", "of dyslam"});
  write("odd/report.json", R"({"input": "a.rawlog", "frames": "x"})");
  expectRefusal("dyslam-eval", "run " + at("odd"), {"report.json: ", "\"frames\"", "of dyslam"});
  // One of an earlier version, without most fields, and of a run that was moved without its truth.
  write("odd/report.json", R"({"input": "a.rawlog", "stage_ms": {"c": 2.5}, "ms_per_scan": null})");
  const Outcome outcome = run("dyslam-eval", "run " + at("odd"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("2.50"), std::string::npos) << outcome.out;
  write("x.gt/poses_tum.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  const Outcome with_truth = run("dyslam-eval", "run " + at("odd") + " --truth " + at("x.gt"));
  EXPECT_EQ(with_truth.code, 0) << with_truth.err;
  EXPECT_EQ(with_truth.err.find("no errors computed"), std::string::npos) << with_truth.err;
  EXPECT_NE(with_truth.out.find("1.0000"), std::string::npos)
      << with_truth.out;  // ratio of the forward motion
}

TEST_F(BadFiles, FoldersOfLabels)
{
  const std::string two_labels("\0\0\0\0\0\0\0\0", 8);
  write("beside/000000.label", two_labels);
  fs::create_directories(at("beside/labels"));
  write("within/labels/000000.label", two_labels);
  const Outcome same = run(
      "dyslam-eval", "segmentation --reference " + at("within") + " --estimate " + at("beside"));
  EXPECT_EQ(same.code, 0) << "an empty folder of labels is none: " << same.err;
  fs::create_directories(at("unlabelled/labels"));
  expectRefusal("dyslam-eval",
                "segmentation --reference " + at("within") + " --estimate " + at("unlabelled"),
                {"unlabelled: has no .label files"});
  write("other/000720.label", two_labels);
  expectRefusal(
      "dyslam-eval", "segmentation --reference " + at("within") + " --estimate " + at("other"),
      {"other: no .label file has the name of one in", "(000720 and 000000, for example)"});
  expectRefusal("dyslam-eval",
                "segmentation --reference " + at("within") + " --estimate " + at("within/labels"),
                {"within/labels: has the labels of the reference"});
  write("third/000000.label", two_labels);
  const Outcome both = run("dyslam-eval", "segmentation --reference " + at("within") +
                                              " --estimate " + at("beside") + " " + at("third"));
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_NE(both.out.find("third:\n"), std::string::npos) << both.out;
}

TEST_F(BadFiles, ScansToConvert)
{
  fs::create_directories(at("none_inside"));
  const std::string out = " -o " + at("never.rawlog");
  expectRefusal("scans2rawlog", "-i " + at("none") + out, {"none: no such file or folder"});
  expectRefusal("scans2rawlog", "-i " + at("none_inside") + out, {"has no .bin, .pcd or .ply"});
  expectRefusal("scans2rawlog", "-i " + at("empty") + out,
                {"empty: ", "give a folder, .pcap, .bag, .db3 or .mcap"});
  expectRefusal("scans2rawlog", "-i " + at("good.rawlog") + out,
                {"good.rawlog: ends in .rawlog: dyslam reads rawlogs as they are"});
  expectRefusal("scans2rawlog", "-i " + write("drive.osf", "x") + out,
                {"drive.osf: is a recording of Ouster's SDK", "save drive.pcap"});
  expectRefusal("scans2rawlog", "-i " + write("bag/metadata.yaml", "x") + out,
                {"metadata.yaml: ", "give the bag's folder"});
  expectRefusal("scans2rawlog", "-i " + at("none_inside") + " -o " + at("never"),
                {"never: name the recording to write *.rawlog"});
  write("odd_bin/0.bin", std::string(1607, 'x'));
  expectRefusal("scans2rawlog", "-i " + at("odd_bin") + out, {"0.bin", "16"});
  write("odd_pcd/0.pcd", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n");
  expectRefusal("scans2rawlog", "-i " + at("odd_pcd") + out, {"0.pcd"});
  expectRefusal("kitti2rawlog", "--kind odometry -i " + at("none") + out, {"none: no such folder"});
  expectRefusal("kitti2rawlog", "--kind odometry -i " + at("none_inside") + out, {"has no scans"});
  expectRefusal("kitti2rawlog", "--kind odd -i " + at("none_inside") + out, {"odd", "--help"});
  EXPECT_FALSE(fs::exists(at("never.rawlog")));
  EXPECT_FALSE(fs::exists(at("never.rawlog.tmp")));
}
}  // namespace
}  // namespace dyslam
