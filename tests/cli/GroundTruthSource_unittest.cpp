// SPDX-License-Identifier: BSD-3-Clause
// Statements of a run and its evaluation about the ground truth: the source of the true poses, the
// part of a run and the tracks that they cover, and flags that do not fit the given files.
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <tuple>
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

  /** Output of dyslam-eval, followed by its JSON. */
  [[nodiscard]] std::string evaluated(const std::string& arguments) const
  {
    const Outcome outcome = runProgram(
        "dyslam-eval", "run --json " + folder_.file("e.json") + " " + arguments, folder_.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    return outcome.out + contentOf(folder_.file("e.json"));
  }

  TestFolder folder_;
};

/** A line of tracks.txt: a box of frame 0 in the lidar frame. \param rectangle rectangle in the
 * image */
std::string trackLine(
    int id, const std::string& type, double x, double y, const std::string& rectangle = "0 0 0 0")
{
  std::ostringstream line;
  line << "0 " << id << " " << type << " 0 0 -10 " << rectangle << " 1.5 1.8 4 " << x << " " << y
       << " -1 0\n";
  return line.str();
}

/** `count` poses of a straight drive, one a second. */
std::string posesOf(int count)
{
  std::ostringstream poses;
  for (int i = 0; i < count; ++i)
  {
    poses << i << " " << i << " 0 0 0 0 0 1\n";
  }
  return poses.str();
}

/** Figures by `dyslam-eval tracks`. */
nlohmann::json trackScores(const TestFolder& folder,
                           const std::string& reference,
                           const std::string& estimate,
                           const std::string& flags = "")
{
  const Outcome outcome =
      runProgram("dyslam-eval",
                 "tracks --reference " + folder.file(reference) + " --estimate " +
                     folder.file(estimate) + " --json " + folder.file("e.json") + flags,
                 folder.path());
  EXPECT_EQ(0, outcome.code) << outcome.err;
  return nlohmann::json::parse(contentOf(folder.file("e.json")));
}
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
  EXPECT_TRUE(contains(gnss, "; no NEES\n")) << gnss;
  EXPECT_TRUE(contains(gnss, "run: the figures are differences to GNSS/INS: ")) << gnss;
  EXPECT_FALSE(contains(exact, "differences to")) << exact;
  EXPECT_FALSE(contains(gnss, "scan to scan")) << gnss;
  EXPECT_FALSE(contains(gnss, "\"odometry_nees\"")) << gnss;
  EXPECT_TRUE(contains(gnss, "\"exact\": false")) << gnss;
  EXPECT_TRUE(contains(gnss, "\"rpe\"")) << "errors are computed: " << gnss;
  EXPECT_TRUE(contains(contentOf(run + "/report.html"), "GNSS/INS (oxts), not exact"));
  EXPECT_TRUE(contains(contentOf(run + "/report.html"), "\"difference_to\":\"GNSS/INS\""));
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
  // The source may be stated in a folder that the ground truth has been moved to.
  const std::string given = " --truth " + folder_.file("moved.gt");
  folder_.write("moved.gt/poses.ini", "[poses]\nsource = given\nname = icp.txt\n");
  EXPECT_TRUE(contains(evaluated(run + given), "given poses (icp.txt), not known to be exact"));
  // The report of a run by an older version does not state the source.
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

/** Tracks as KITTI's: boxes in images of a camera that looks ahead, instances equal to track id
 * + 1. */
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

TEST(TrueTracks, AgainstThemselvesScoreFullyAsFileOrFolder)
{
  const TestFolder folder;
  folder.write("x.gt/tracks.txt", trackLine(0, "Car", 10, 2) + trackLine(1, "Van", 20, -3) +
                                      trackLine(2, "Truck", 30, 8) + trackLine(3, "Car", 70, 4));
  const std::string file = "x.gt/tracks.txt";
  for (const auto& [reference, estimate, boxes] :
       {std::tuple<std::string, std::string, int>{"x.gt", "x.gt", 3},
        {"x.gt", file, 3},
        {file, "x.gt", 4}})
  {
    SCOPED_TRACE(reference + " and " + estimate);
    const auto scores = trackScores(folder, reference, estimate);
    for (const char* name : {"Vehicle", "all"})
    {
      EXPECT_EQ(boxes, scores.at(name).at("references")) << name;
      EXPECT_EQ(0, scores.at(name).at("false_alarms")) << name;
      EXPECT_DOUBLE_EQ(1, scores.at(name).at("mota")) << name;
      EXPECT_DOUBLE_EQ(1, scores.at(name).at("recall")) << name;
    }
    EXPECT_EQ(0U, scores.count("Van"));
  }
  const auto files = trackScores(folder, file, file);
  EXPECT_EQ(2, files.at("Car").at("references"));
  EXPECT_EQ(1, files.at("Van").at("references"));
}

/** The camera's view ends at 40.5 degrees. */
TEST(TrueTracks, TheBorderOfTheViewCausesNeitherMissesNorFalseAlarms)
{
  const TestFolder folder;
  const auto at = [](int id, double azimuth_deg, double range)
  {
    const double azimuth = azimuth_deg * M_PI / 180;
    return trackLine(id, "Car", range * std::cos(azimuth), range * std::sin(azimuth),
                     "100 100 200 150");
  };
  folder.write("x.gt/tracks.txt", at(0, 0, 10) + at(1, 40.8, 20) + at(2, -40.2, 20));
  const std::string found = at(10, 0, 10) + at(11, 40.2, 20) + at(12, -40.8, 20);
  const std::string unlabelled = at(13, 90, 15) + at(14, -170, 15);
  folder.write("run/tracks.txt", found + unlabelled);
  for (const char* estimate : {"run", "run/tracks.txt"})
  {
    const auto all = trackScores(folder, "x.gt", estimate).at("all");
    EXPECT_EQ(2, all.at("references")) << estimate;
    EXPECT_EQ(0, all.at("misses")) << estimate;
    EXPECT_EQ(0, all.at("false_alarms")) << estimate;
  }
  const auto around = trackScores(folder, "x.gt", "run", " --view 360").at("all");
  EXPECT_EQ(3, around.at("references"));
  EXPECT_EQ(2, around.at("false_alarms"));
}

TEST(RunCoverage, APartOfTheRunIsNotedOnce)
{
  const TestFolder folder;
  folder.write("run/trajectory_tum.txt", posesOf(6));
  folder.write("run/odometry_tum.txt", posesOf(6));
  const auto notes = [&]
  {
    const Outcome outcome = runProgram("dyslam-eval", "run " + folder.file("run"), folder.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    return outcome.err;
  };
  folder.write("run/reference_tum.txt", posesOf(2));
  const std::string part = notes();
  const std::string note = "trajectory_tum.txt: only 2 of 6 poses have one of 2 in " +
                           folder.file("run/reference_tum.txt") + " within 0.001 s";
  EXPECT_TRUE(contains(part, note)) << part;
  EXPECT_FALSE(contains(part, "odometry_tum.txt")) << part;
  folder.write("run/reference_tum.txt", posesOf(6));
  EXPECT_FALSE(contains(notes(), "only"));
}

TEST(RunNames, KeepTheirDotsAndFilesLoseTheirEnding)
{
  const TestFolder folder;
  for (const std::string name : {"b/x.1", "b/x.2"})
  {
    folder.write(name + "/trajectory_tum.txt", posesOf(3));
    folder.write(name + "/reference_tum.txt", posesOf(3));
  }
  const auto namesIn = [&](const std::string& arguments, const char* list)
  {
    const Outcome outcome =
        runProgram("dyslam-eval", arguments + " --json " + folder.file("e.json"), folder.path());
    EXPECT_EQ(0, outcome.code) << outcome.err;
    const auto json = nlohmann::json::parse(contentOf(folder.file("e.json")));
    std::vector<std::string> names;
    for (const auto& entry : json.at(list))
    {
      names.push_back(entry.at("name"));
    }
    return names;
  };
  using Names = std::vector<std::string>;
  EXPECT_EQ(Names({"x.1", "x.2"}),
            namesIn("run " + folder.file("b/x.1") + " " + folder.file("b/x.2/"), "runs"));
  const std::string poses = folder.file("b/x.1/trajectory_tum.txt");
  EXPECT_EQ(Names({"trajectory_tum"}),
            namesIn("trajectory --reference " + poses + " --estimate " + poses, "trajectories"));
}

TEST(Runs, ThoseAmongOtherFoldersAreEvaluated)
{
  const TestFolder folder;
  folder.write("out/a/trajectory_tum.txt", posesOf(3));
  folder.write("out/a/report.json", R"({"frames": 3, "finished": false, "ms_per_scan": 0.0})");
  folder.write("out/batch/table.txt", "");
  folder.write("out/list.txt", "");
  const Outcome some = runProgram("dyslam-eval", "run " + folder.path() + "/out/*", folder.path());
  EXPECT_EQ(0, some.code) << some.err;
  EXPECT_TRUE(contains(some.err, "out/batch: left out: has no trajectory_tum.txt")) << some.err;
  EXPECT_TRUE(contains(some.err, "out/list.txt: left out: is not a folder")) << some.err;
  EXPECT_FALSE(contains(some.out, "0.0")) << some.out;  // ms/scan
  const Outcome none = runProgram(
      "dyslam-eval", "run " + folder.file("out/batch") + " " + folder.file("out"), folder.path());
  EXPECT_EQ(1, none.code);
  EXPECT_TRUE(contains(none.err, "none of the 2 folders is that of a run")) << none.err;
}

TEST(Runs, OneWithADamagedReportDoesNotEndTheTable)
{
  const TestFolder folder;
  for (const std::string name : {"a", "broken", "c"})
  {
    folder.write(name + "/trajectory_tum.txt", posesOf(3));
    folder.write(name + "/reference_tum.txt", posesOf(3));
    folder.write(name + "/report.json", name == "broken" ? "{ \"frames\": " : "{\"frames\": 3}");
  }
  const auto evaluate = [&](const std::string& names)
  {
    std::string arguments = "run --csv " + folder.file("t.csv");
    std::istringstream words(names);
    for (std::string name; words >> name;)
    {
      arguments += " " + folder.file(name);
    }
    return runProgram("dyslam-eval", arguments, folder.path());
  };
  const Outcome some = evaluate("broken a c");
  EXPECT_EQ(1, some.code);
  EXPECT_TRUE(contains(some.err, "broken/report.json: is not the JSON report")) << some.err;
  EXPECT_TRUE(contains(some.err, "1 of 3 runs not evaluated: " + folder.file("broken") + "\n"))
      << some.err;
  const std::string table = contentOf(folder.file("t.csv"));
  EXPECT_TRUE(contains(table, "\na,final,3,") && contains(table, "\nc,final,3,")) << table;
  EXPECT_FALSE(contains(table, "broken")) << table;
  const Outcome none = evaluate("broken broken");
  EXPECT_EQ(1, none.code);
  EXPECT_TRUE(contains(none.err, "dyslam-eval: " + folder.file("broken/report.json"))) << none.err;
}

TEST(TrajectoryPaths, NeedNoReference)
{
  const TestFolder folder;
  const std::string a = folder.write("a.txt", posesOf(11));
  const std::string b = folder.write("b.txt", posesOf(5));
  const auto evaluate = [&](const std::string& flags)
  {
    return runProgram("dyslam-eval", "trajectory --estimate " + a + " " + b + " " + flags,
                      folder.path());
  };
  const Outcome plotted =
      evaluate("--plot " + folder.file("p.png") + " --json " + folder.file("e.json"));
  EXPECT_EQ(0, plotted.code) << plotted.err;
  EXPECT_TRUE(contains(plotted.err, "note: no --reference")) << plotted.err;
  EXPECT_TRUE(contains(contentOf(folder.file("p.png")), "PNG"));
  const auto json = nlohmann::json::parse(contentOf(folder.file("e.json")));
  const auto& first = json.at("trajectories").at(0);
  EXPECT_NEAR(10, first.at("length_m"), 1e-6);
  EXPECT_NEAR(10, first.at("duration_s"), 1e-6);
  EXPECT_NEAR(4, json.at("trajectories").at(1).at("start_to_end_m"), 1e-6);
  for (const std::string flag : {"--align none", "--lengths 5", "--tolerance 1", "--interpolate 1",
                                 "--time-offset 1", "--reference-body 0", "--reference-times t.txt",
                                 "--statistics", "--per-length", "--paper odometry/07"})
  {
    const Outcome outcome = evaluate(flag);
    EXPECT_EQ(1, outcome.code) << flag;
    EXPECT_TRUE(contains(outcome.err, flag.substr(0, flag.find(' ')) + " requires --reference"))
        << outcome.err;
  }
  EXPECT_TRUE(contains(evaluate("--camera reference").err, "there is no --reference"));
  const Outcome twice = evaluate("--lengths 2,3,2 --reference " + a);
  EXPECT_EQ(1, twice.code);
  EXPECT_TRUE(contains(twice.err, "--lengths: '2' is given twice")) << twice.err;
  const Outcome is_short = evaluate("--per-length --reference " + a);
  EXPECT_EQ(0, is_short.code) << is_short.err;
  EXPECT_TRUE(contains(is_short.err, "no segment of 100 m fits into the reference"))
      << is_short.err;
  EXPECT_FALSE(contains(is_short.out, "length [m]\n")) << "a table without figures";
}

TEST(MapDistances, OfMapsWithoutLabels)
{
  const TestFolder folder;
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i)
  {
    points.emplace_back(static_cast<float>(i), 0.F, 0.F);
  }
  const std::string a = folder.file("a.ply");
  writePly(a, points, std::vector<float>(points.size(), 0.123F));
  points.emplace_back(0.F, 3.F, 0.F);  // a point that only the second map has
  const std::string b = folder.file("b.ply");
  writePly(b, points);
  const std::string maps = "map --reference " + a + " --estimate " + b + " ";
  const auto evaluate = [&](const std::string& flags)
  { return runProgram("dyslam-eval", maps + flags, folder.path()); };
  const Outcome outcome = evaluate("--json " + folder.file("e.json"));
  EXPECT_EQ(0, outcome.code) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "a.ply has no labels (intensity 0.123000 is none)"))
      << outcome.err;
  const auto json = nlohmann::json::parse(contentOf(folder.file("e.json")));
  const auto& map = json.at("maps").at(0);
  EXPECT_EQ(101, map.at("estimate").at("points"));
  EXPECT_NEAR(3, map.at("estimate").at("max_m"), 1e-6);
  EXPECT_NEAR(100.0 / 101, map.at("estimate").at("shares").at(0).at("share"), 1e-9);
  EXPECT_EQ(0, map.at("reference").at("max_m"));

  const std::string made = folder.file("d.ply");
  const Outcome written = evaluate("--distances " + made);
  EXPECT_EQ(0, written.code) << written.err;
  EXPECT_EQ("", written.err);
  EXPECT_EQ(101U, readCloud(made).size());
  EXPECT_TRUE(contains(contentOf(made), "property float scalar_distance"));
  const auto expect = [&](const std::string& flags, const std::string& part)
  {
    const Outcome refused = evaluate(flags);
    EXPECT_EQ(1, refused.code) << flags;
    EXPECT_TRUE(contains(refused.err, part)) << refused.err;
  };
  expect("--distances " + folder.file("d.png"), "the ending must be .ply");
  expect("--distances " + b, "is an input, too");
  expect("--distances " + made + " --radius 0.2", "excludes");
  expect("--radius 0.2", "which --radius and --voxel need");
  expect(a + " --distances " + made, "writes the points of one --estimate");
}

TEST(EvaluationFlags, ThoseWithoutAnEffectAreErrors)
{
  const TestFolder folder;
  const std::string tum = folder.write("tum.txt", posesOf(3));
  const std::string kitti = folder.write(
      "kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n1 0 0 2 0 1 0 0 0 0 1 0\n");
  const auto expect = [&](const std::string& arguments, int code, const std::string& part)
  {
    const Outcome outcome = runProgram("dyslam-eval", arguments, folder.path());
    EXPECT_EQ(code, outcome.code) << arguments << ": " << outcome.err;
    EXPECT_TRUE(contains(outcome.err, part)) << arguments << ": " << outcome.err;
  };
  const std::string files = "trajectory --estimate " + tum + " --reference ";
  expect(files + kitti, 0, "");
  expect(files + kitti + " --tolerance 0.01", 1, "kitti.txt: has no time stamps");
  expect(files + kitti + " --time-offset 0", 1, "leave --time-offset out");
  expect(files + kitti + " --interpolate 1", 1, "leave --interpolate out");
  expect(files + tum + " --interpolate 1 --tolerance 1", 1, "excludes");
  expect(files + tum + " --tolerance 0.01 --time-offset 0", 0, "");
  const std::string two = "trajectory --reference " + tum + " --estimate " + tum + " " + tum + " ";
  expect(two + "--time-offset 0 -0.001", 0, "");
  expect(two + "--reference-body '0 0 1 0 0 0' '-1 0 0 0 0 0'", 0, "");
  for (const std::string flag : {"--time-offset 0 1 2", "--camera none none none", "--calib a b c",
                                 "--reference-body 1 2 3"})
  {
    expect(two + flag, 1,
           flag.substr(0, flag.find(' ')) +
               " has 3 values; give one for all estimates, or one for each of the 2");
  }
  expect("tables runs --runs a=b", 1, "excludes");
  expect("tables", 1, "give a folder of runs, or --runs HEADING=FOLDER");
  expect("tables --runs a=b a=c", 1, "--runs: 'a' is given twice");

  const std::string boxes = folder.write("boxes.txt", trackLine(1, "Car", 10, 2));
  const std::string tracks = "tracks --estimate " + boxes + " --reference ";
  expect(tracks + boxes, 0, "");
  for (const std::string flag : {"--min-points 5", "--min-speed 1", "--max-range 9", "--view 90",
                                 "--first-frame 1", "--instance-offset 1"})
  {
    expect(tracks + boxes + " " + flag, 1,
           flag.substr(0, flag.find(' ')) + ": selects boxes of a folder x.gt");
  }
  expect(tracks + boxes + " --iou 0.5 --distance 2", 1, "excludes");

  const std::string self = "map --self x.rawlog --estimate " + tum;
  for (const char* flag : {"--labels x.label", "--radius 0.1", "--voxel 0.2"})
  {
    expect(self + " " + flag, 1, "excludes");
  }
  expect(self + " -c kitti_mot.ini", 1, "these settings are for dyslam-eval, not for dyslam");
  expect(self + " " + tum + " " + tum + " --poses-of lidar vehicle", 1,
         "--poses-of has 2 values; give one for all trajectories, or one for each of the 3");
  expect(self + " " + tum + " " + tum + " --time-offset 0 1", 1,
         "--time-offset has 2 values; give one for all trajectories, or one for each of the 3");
  const std::string maps = "map --reference a.ply --estimate b.ply";
  for (const std::string flag :
       {"--config a.ini", "--neighbourhood 1", "--min-neighbours 5", "--points 9", "--tolerance 1",
        "--poses-of lidar", "--time-offset 1", "--skip-first-n 1", "--only-first-n 1"})
  {
    expect(maps + " " + flag, 1, flag.substr(0, flag.find(' ')) + " requires --self");
  }
}
}  // namespace dyslam
