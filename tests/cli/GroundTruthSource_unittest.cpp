// SPDX-License-Identifier: BSD-3-Clause
// What a run and its evaluation say about where the true poses are from.
#include <dyslam/formats/LabelFiles.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "RunProgram.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Four scans of the bundled recording of a VLP-16, with its true poses and no other truth. */
class GroundTruthSource : public testing::Test
{
 protected:
  GroundTruthSource()
  {
    const std::string bundled = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16";
    fs::create_symlink(bundled + ".rawlog", folder_.file("x.rawlog"));
    fs::create_directories(folder_.file("x.gt"));
    fs::copy_file(bundled + ".gt/poses_tum.txt", folder_.file("x.gt/poses_tum.txt"));
    fs::copy_file(bundled + ".gt/simulator.ini", folder_.file("simulator.ini"));
  }

  void slam(const std::string& output) const
  {
    const Outcome outcome = runProgram(
        "dyslam",
        "-v ERROR -i " + folder_.file("x.rawlog") + " --only-first-n 4 -o " + folder_.file(output),
        folder_.path());
    ASSERT_EQ(0, outcome.code) << outcome.err;
  }

  /** What dyslam-eval prints and its JSON. */
  [[nodiscard]] std::string evaluated(const std::string& arguments) const
  {
    const Outcome outcome = runProgram(
        "dyslam-eval", "run --json " + folder_.file("e.json") + " " + arguments, folder_.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    return outcome.out + contentOf(folder_.file("e.json"));
  }

  TestFolder folder_;
};
}  // namespace

TEST_F(GroundTruthSource, NeesIsForExactOneOnly)
{
  const std::string run = folder_.file("run");
  fs::copy_file(folder_.file("simulator.ini"), folder_.file("x.gt/simulator.ini"));
  slam("run");
  const std::string exact = evaluated(run);
  EXPECT_TRUE(contains(exact, "run: ground truth: simulated, exact\n")) << exact;
  EXPECT_TRUE(contains(exact, "scan to scan")) << exact;
  EXPECT_TRUE(contains(exact, "\"odometry_nees\"")) << exact;
  EXPECT_TRUE(contains(exact, "\"exact\": true")) << exact;
  EXPECT_TRUE(contains(contentOf(run + "/report.html"), "simulated, exact"));

  fs::remove(folder_.file("x.gt/simulator.ini"));
  folder_.write("x.gt/poses.ini", "[poses]\nsource = gnss_ins\nname = oxts\n");
  EXPECT_TRUE(contains(evaluated(run), "simulated, exact")) << "as the run recorded it";
  slam("run");
  const std::string gnss = evaluated(run);
  EXPECT_TRUE(contains(gnss, "run: ground truth: GNSS/INS (oxts), not exact; ")) << gnss;
  EXPECT_TRUE(contains(gnss, "NEES is not computed, as it would")) << gnss;
  EXPECT_FALSE(contains(gnss, "scan to scan")) << gnss;
  EXPECT_FALSE(contains(gnss, "\"odometry_nees\"")) << gnss;
  EXPECT_TRUE(contains(gnss, "\"exact\": false")) << gnss;
  EXPECT_TRUE(contains(gnss, "\"rpe\"")) << "errors are computed: " << gnss;
  EXPECT_TRUE(contains(contentOf(run + "/report.html"), "GNSS/INS (oxts), not exact"));
  EXPECT_TRUE(contains(contentOf(run + "/report.json"), "\"source\": \"gnss_ins\""));
}

TEST_F(GroundTruthSource, WithoutAMarkItIsUnknown)
{
  const std::string run = folder_.file("run");
  slam("run");
  const std::string unknown = evaluated(run);
  EXPECT_TRUE(contains(unknown, "ground truth: of unknown source, not known to be exact; "))
      << unknown;
  EXPECT_FALSE(contains(unknown, "scan to scan")) << unknown;
  // The mark may be in a folder that the recording has been moved to.
  const std::string given = " --truth " + folder_.file("moved.gt");
  folder_.write("moved.gt/poses.ini", "[poses]\nsource = given\nname = icp.txt\n");
  EXPECT_TRUE(contains(evaluated(run + given), "given poses (icp.txt), not known to be exact"));
  // A run of an older program has no word of it in its report.
  std::string report = contentOf(run + "/report.json");
  const std::size_t at = report.find("\"ground_truth\"");
  ASSERT_NE(at, std::string::npos) << report;
  report.replace(at, std::string("\"ground_truth\"").size(), "\"no_such_key\"");
  folder_.write("run/report.json", report);
  EXPECT_TRUE(contains(evaluated(run), "of unknown source"));
  fs::copy_file(folder_.file("simulator.ini"), folder_.file("x.gt/simulator.ini"));
  EXPECT_TRUE(contains(evaluated(run), "simulated, exact"));
}

TEST_F(GroundTruthSource, ADamagedMarkIsAnErrorBeforeTheRun)
{
  folder_.write("x.gt/poses.ini", "[poses]\nsource = guessed\n");
  const Outcome outcome = runProgram(
      "dyslam", "-i " + folder_.file("x.rawlog") + " -o " + folder_.file("run"), folder_.path());
  EXPECT_EQ(1, outcome.code);
  EXPECT_TRUE(contains(outcome.err, "poses.ini:2")) << outcome.err;
  EXPECT_FALSE(fs::exists(folder_.file("run")));
}

/** As KITTI's: boxes in images of a camera that looks ahead, instances one more than track ids. */
TEST(TrueTracks, OfCameraImagesAreEvaluatedInTheView)
{
  const TestFolder folder;
  const std::string rest = " 1.5 1.8 4 ";  // height, width, length
  const std::string ahead = "0 0 Car 0 0 -10 100 100 200 150" + rest + "10 2 -1 0\n";
  const std::string behind = "0 1 Car 0 0 -10 300 100 400 150" + rest + "-10 2 -1 0\n";
  fs::create_directories(folder.file("x.gt/labels"));
  folder.write("x.gt/tracks.txt", ahead + behind);
  folder.write("run/tracks.txt", ahead);
  std::vector<Label> labels(20, makeLabel(10, 1));
  labels.insert(labels.end(), 3, makeLabel(10, 2));
  writeLabels(folder.file("x.gt/labels/000000.label"), labels);
  const auto evaluated = [&](const std::string& flags)
  {
    const Outcome outcome =
        runProgram("dyslam-eval",
                   "tracks --reference " + folder.file("x.gt") + " --estimate " +
                       folder.file("run") + " --json " + folder.file("e.json") + flags,
                   folder.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    const auto all = nlohmann::json::parse(contentOf(folder.file("e.json"))).at("all");
    return std::pair(outcome.out,
                     all.at("references").get<int>() * 10 + all.at("misses").get<int>());
  };
  const auto [said, in_view] = evaluated("");
  EXPECT_TRUE(contains(said, "within 81 degrees ahead")) << said;
  EXPECT_EQ(10, in_view) << "the box ahead, which has 20 points";
  const auto [silent, all_around] = evaluated(" --view 360 --min-points 3");
  EXPECT_FALSE(contains(silent, "degrees ahead")) << silent;
  EXPECT_EQ(21, all_around) << "that behind is missed";
  EXPECT_EQ(0, evaluated(" --instance-offset 0").second) << "a box without points is ignored";
}
}  // namespace dyslam
