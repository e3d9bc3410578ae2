// SPDX-License-Identifier: BSD-3-Clause
// Programs with bad input: each must print one line that names the file or field and what to do,
// end with exit code 1, and leave no partial files.
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/io/RawlogWriter.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/serialization/CArchive.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr std::size_t scan_count = 12;

class BadInput : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    folder_ = fs::temp_directory_path() / ("dyslam_bad_input_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    record("good.rawlog", [](std::size_t, Scan&) { return true; });
    write("file", "x");
    write("empty", "");
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  /** Writes a short recording. \param change modifies its scans */
  static void record(const std::string& name, const std::function<void(std::size_t, Scan&)>& change)
  {
    sim::SimulatorOptions options;
    options.sensor = sim::SensorKind::vlp16;
    options.columns = 600;
    options.traffic = 0.3;
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    RawlogWriter writer(at(name));
    for (std::size_t i = 0; i < scan_count; ++i)
    {
      auto simulated = simulator.next();
      change(i, simulated.scan);
      writer.write(simulated.scan, simulated.T_map_vehicle);
    }
    writer.close();
  }

  static std::string at(const std::string& name) { return (folder_ / name).string(); }

  static std::string write(const std::string& name, const std::string& content)
  {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return at(name);
  }

  template <typename... Objects>
  static std::string writeObjects(const std::string& name, const Objects&... objects)
  {
    mrpt::io::CFileGZOutputStream file(at(name));
    auto archive = mrpt::serialization::archiveFrom(file);
    (archive << ... << objects);
    return at(name);
  }

  /** \param arguments words without blanks or quotes. */
  static Outcome run(const std::string& program, const std::string& arguments)
  {
    return runProgram(program, arguments, folder_.string());
  }

  /** Fails unless the program ends with 1 and its only line on stderr has all of `parts`. */
  static void expectRefusal(const std::string& program,
                            const std::string& arguments,
                            const std::vector<std::string>& parts)
  {
    const Outcome outcome = run(program, arguments);
    const std::string shown = program + " " + arguments + "\n" + outcome.err;
    EXPECT_EQ(outcome.code, 1) << shown;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << shown;
    EXPECT_EQ(outcome.err.rfind(program + ": ", 0), 0U) << shown;
    for (const auto& part : parts)
    {
      EXPECT_NE(outcome.err.find(part), std::string::npos) << "no '" << part << "' in\n" << shown;
    }
  }

  static std::string slam(const std::string& rawlog, const std::string& output)
  {
    return "-i " + rawlog + " -c vlp16.ini -o " + at(output);
  }

  static std::size_t posesIn(const std::string& run_folder)
  {
    return readTum(at(run_folder) + "/trajectory_tum.txt").size();
  }

  static fs::path folder_;
};
fs::path BadInput::folder_;

TEST_F(BadInput, FilesThatAreNoRawlog)
{
  const std::string text = write("text.rawlog", "hello world, this is no rawlog\n");
  const std::string noise = write("noise.rawlog", std::string(50000, '\x8F'));
  const std::string simplemap = writeObjects("map.rawlog", mrpt::maps::CSimpleMap());
  const std::string flat = writeObjects("flat.rawlog", mrpt::obs::CObservation2DRangeScan());
  // Two programs that read rawlogs.
  const std::vector<std::pair<std::string, std::string>> programs{
      {"dyslam", " -c vlp16.ini -o " + at("never")},
      {"dyslam-map",
       " --trajectory " + write("t.txt", "1 0 0 0 0 0 0 1\n") + " -o " + at("m.pcd")}};
  for (const auto& [program, rest] : programs)
  {
    expectRefusal(program, "-i " + at("none.rawlog") + rest, {"none.rawlog", "no such file"});
    expectRefusal(program, "-i " + at("empty") + rest, {"empty: is empty", "kitti2rawlog"});
    expectRefusal(program, "-i " + text + rest, {"text.rawlog: is not a rawlog", "kitti2rawlog"});
    expectRefusal(program, "-i " + noise + rest, {"noise.rawlog: is not a rawlog"});
    expectRefusal(program, "-i " + simplemap + rest,
                  {"map.rawlog", "it holds a mrpt::maps::CSimpleMap"});
    expectRefusal(program, "-i " + flat + rest,
                  {"flat.rawlog: has no 3D scans", "1 CObservation2DRangeScan", "3D LiDAR"});
  }
  expectRefusal("dyslam-map", "-i " + at("") + programs[1].second,
                {"is a folder", "a file is needed"});
  EXPECT_FALSE(fs::exists(at("never")));
  EXPECT_FALSE(fs::exists(at("m.pcd")));
}

TEST_F(BadInput, ATruncatedRawlogLeavesWhatCameBefore)
{
  const std::string whole = contentOf(at("good.rawlog"));
  const std::string cut = write("cut.rawlog", whole.substr(0, whole.size() * 6 / 10));
  std::size_t scans = 0;
  try
  {
    RawlogSource source(cut);
    for (; source.next(); ++scans)
    {
    }
  }
  catch (const std::exception&)
  {
  }
  ASSERT_GT(scans, 4U);
  ASSERT_LT(scans, scan_count);

  const Outcome outcome = run("dyslam", slam(cut, "cut") + " -v ERROR");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("cut.rawlog: is cut short"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("results of the " + std::to_string(scans) + " scans"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(posesIn("cut"), scans);
  EXPECT_EQ(run("dyslam-eval", "run " + at("cut")).code, 0);
  RawlogSource replay(at("cut") + "/replay.rawlog");
  std::size_t replayed = 0;
  for (; replay.next(); ++replayed)
  {
  }
  EXPECT_EQ(replayed, scans);

  const std::string map = at("cut.ply");
  expectRefusal("dyslam-map",
                "-q -i " + cut + " --trajectory " + at("cut") + "/trajectory_tum.txt -o " + map,
                {"is cut short", "map of the " + std::to_string(scans) + " scans"});
  EXPECT_EQ(run("dyslam-eval", "map --reference " + map + " --estimate " + map).code, 0);
  EXPECT_GT(fs::file_size(map), 1000U);
}

TEST_F(BadInput, PointsThatAreNoneAndAnEmptyScanAreSurvived)
{
  record("spoiled.rawlog",
         [](std::size_t i, Scan& scan)
         {
           if (i == 6)
           {
             scan.points.clear();
             scan.intensity.clear();
             scan.time.clear();
             scan.ring.clear();
             return;
           }
           const float nan = std::numeric_limits<float>::quiet_NaN();
           const float inf = std::numeric_limits<float>::infinity();
           for (std::size_t k = 0; k + 3 < scan.size(); k += 40)
           {
             scan.points[k] = Eigen::Vector3f(nan, 1, 1);
             scan.points[k + 1] = Eigen::Vector3f(1, -inf, inf);
             scan.points[k + 2].setZero();
           }
         });
  const Outcome outcome = run("dyslam", slam(at("spoiled.rawlog"), "spoiled") + " --labels");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("an empty scan (scan 6)"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("1 scan could not be registered; its motion"), std::string::npos)
      << outcome.out;
  EXPECT_EQ(posesIn("spoiled"), scan_count);
  const auto truth = readTum(at("spoiled") + "/reference_tum.txt");
  const auto found = readTum(at("spoiled") + "/trajectory_tum.txt");
  ASSERT_EQ(truth.size(), found.size());
  EXPECT_LT(
      (truth[truth.size() - 1].pose.translation() - found[found.size() - 1].pose.translation())
          .norm(),
      0.3);
  for (const char* file : {"map_static.ply", "trajectory_tum.txt", "graph.g2o"})
  {
    const std::string text = contentOf(at("spoiled") + "/" + file);
    EXPECT_GT(text.size(), 0U) << file;
    EXPECT_TRUE(std::string(file) == "map_static.ply" || text.find("nan") == std::string::npos)
        << file;
  }
}

TEST_F(BadInput, WarningsHaveNoEscapeCodes)
{
  const std::string name =
      "odd\x1b"
      "c.rawlog";
  record(name, [](std::size_t i, Scan& scan)
         { scan.stamp = 100.0 + 0.1 * static_cast<double>(i == 4 ? 3 : i); });
  std::string poses;
  for (std::size_t i = 0; i < scan_count; ++i)
  {
    poses += std::to_string(100.0 + 0.1 * static_cast<double>(i)) + " 0 0 0 0 0 0 1\n";
  }
  const std::string trajectory = write("odd/trajectory.txt", poses);
  const Outcome outcome = run("dyslam-map", "-q -i " + at(name) + " --trajectory " + trajectory +
                                                " -o " + at("odd/map.ply"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("warning: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("odd?c.rawlog"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find('\x1b'), std::string::npos) << outcome.err;
}

TEST_F(BadInput, TimeStampsThatRepeatOrGoBack)
{
  record("stamps.rawlog",
         [](std::size_t i, Scan& scan)
         {
           scan.stamp = 100.0 + 0.1 * static_cast<double>(i);
           scan.stamp -= i == 4 ? 0.1 : 0.0;  // the stamp of the previous scan
           scan.stamp -= i == 8 ? 3.0 : 0.0;  // 3 s back
         });
  const Outcome outcome = run("dyslam", slam(at("stamps.rawlog"), "stamps"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("time stamp of the one before was dropped"), std::string::npos);
  EXPECT_NE(outcome.out.find("goes back was dropped"), std::string::npos) << outcome.out;
  EXPECT_EQ(posesIn("stamps"), scan_count - 2);

  {
    RawlogWriter writer(at("still.rawlog"));
    Scan scan;
    scan.stamp = 50;
    scan.points.assign(100, Eigen::Vector3f(5, 1, 0));
    for (int i = 0; i < 20; ++i)
    {
      writer.write(scan);
    }
    writer.close();
  }
  const Outcome still = run("dyslam", slam(at("still.rawlog"), "still") + " -v ERROR");
  EXPECT_EQ(still.code, 1);
  EXPECT_NE(still.err.find("still.rawlog: the time stamps stand still"), std::string::npos)
      << still.err;
  EXPECT_NE(still.err.find("give the file proper times"), std::string::npos) << still.err;
}

TEST_F(BadInput, OutputsThatCannotBeWritten)
{
  const std::string good = at("good.rawlog");
  expectRefusal("dyslam", slam(good, "file/below"), {"file/below", "choose another --output"});
  expectRefusal("dyslam", slam(good, "file"),
                {"file: cannot make this folder", "choose another --output"});
  expectRefusal("dyslam", "-i " + good + " -c vlp16.ini -o /proc/x", {"/proc/x", "--output"});
  expectRefusal("dyslam", slam(good, "y") + " --profile " + at("file/p.csv"),
                {"p.csv: cannot be written", "--profile"});
  EXPECT_FALSE(fs::exists(at("y")));

  const std::string poses =
      write("poses.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 2 0 0 0 0 0 1\n");
  expectRefusal("dyslam-map", "-i " + good + " --trajectory " + poses + " -o " + at("file/m.pcd"),
                {"file: cannot make this folder", "choose another --output"});
  expectRefusal("dyslam-map", "-i " + good + " --trajectory " + poses + " -o " + at("m.xyz"),
                {"m.xyz: unknown ending '.xyz'"});
  for (const char* flag : {"--json ", "--csv ", "--plot "})
  {
    expectRefusal(
        "dyslam-eval",
        "trajectory --reference " + poses + " --estimate " + poses + " " + flag + at("file/x.png"),
        {"file/x.png: cannot be written"});
  }
  expectRefusal(
      "dyslam-eval",
      "trajectory --reference " + poses + " --estimate " + poses + " --plot " + at("p.xyz"),
      {"p.xyz: the ending must be .png"});
  fs::create_directories(at("scans"));
  write("scans/0.bin", std::string(1600, '\x3F'));
  expectRefusal("scans2rawlog", "-i " + at("scans") + " -o " + at("file/a.rawlog"), {"a.rawlog"});
  expectRefusal("kitti2rawlog", "--kind odometry -i " + at("scans") + " -o /proc/a.rawlog",
                {"a.rawlog"});
}

TEST_F(BadInput, Configs)
{
  const auto withIni = [](const std::string& content, const std::vector<std::string>& parts)
  {
    const std::string ini = write("bad.ini", content);
    expectRefusal("dyslam", "-i " + at("good.rawlog") + " -c " + ini + " -o " + at("never"), parts);
  };
  withIni("[refin]\nmethod = gicp\n", {"bad.ini:1", "'refin'", "did you mean 'refine'"});
  withIni("[refine]\nmethode = gicp\n", {"bad.ini:2", "'methode'", "did you mean 'method'"});
  withIni("[refine]\nmethod = gigp\n", {"bad.ini:2", "'gigp'", "did you mean 'gicp'"});
  withIni("[refine]\ncell_size = abc\n", {"bad.ini:2", "cell_size = abc", "is not a number"});
  withIni("[refine]\ncell_size = nan\n", {"bad.ini:2", "cell_size = nan"});
  withIni("[refine]\ncell_size = -1\n", {"bad.ini:2", "cell_size = -1", "out of range"});
  withIni("[pipeline]\nthreads = 1.5\n", {"threads = 1.5", "is not a whole number"});
  withIni("[output]\nreplay = maybe\n", {"replay = maybe", "use true or false"});
  withIni("cell_size = 1\n", {"bad.ini:1", "before the first [section]"});
  withIni("[refine]\ncell_size = 1\ncell_size = 2\n", {"bad.ini:3", "given twice"});
  withIni("[refine\n", {"bad.ini:1", "write [name]"});
  withIni(std::string("\x01\x02\x1B[31m\0", 8), {"bad.ini:1"});

  const std::string start = "-i " + at("good.rawlog") + " -o " + at("never") + " ";
  expectRefusal("dyslam", start + "-c " + at("none.ini"), {"none.ini: no such file", "vlp16.ini"});
  expectRefusal("dyslam", start + "--set refine.cell_size", {"write --set section.key=value"});
  expectRefusal("dyslam", start + "--set refine.cel_size=1", {"did you mean 'cell_size'"});
  expectRefusal("dyslam", start + "--set refine.cell_size=1e9",
                {"cell_size = 1e+09", "out of range"});
  expectRefusal("dyslam", start + "--skip-first-n -3", {"--skip-first-n", "--help"});
  expectRefusal("dyslam", start + "--skip-first-n 500", {"skip_first_n = 500", "the file has 12"});
  expectRefusal("dyslam-map",
                "-i " + at("good.rawlog") + " --trajectory x -o m.pcd --set map.nothing=1",
                {"[map]: unknown key 'nothing'"});
  expectRefusal(
      "dyslam-map",
      "-i " + at("good.rawlog") + " --trajectory x -o m.pcd -c vlp16.ini --set mapp.voxel_size=1",
      {"--set mapp.voxel_size=1", "sections map, labels, preprocess"});
  expectRefusal("dyslam-map",
                "-i " + at("good.rawlog") + " --trajectory x -o m.pcd -c " +
                    write("bad.ini", "[mapp]\nvoxel_size = 1\n"),
                {"bad.ini:1", "'mapp'", "did you mean 'map'"});
  expectRefusal("dyslam", start + "--start 2 --end 1", {"end = 1 s is not after start = 2 s"});
  expectRefusal("dyslam", start + "--start 999", {"start = 999 s", "the file has 12 scans"});
  EXPECT_FALSE(fs::exists(at("never") + "/trajectory_tum.txt"));
}

TEST_F(BadInput, FoldersToResume)
{
  expectRefusal("dyslam", "--resume -o " + at("nowhere"),
                {"nowhere: no such folder", "--output names the folder of the run to resume"});
  EXPECT_FALSE(fs::exists(at("nowhere")));
  fs::create_directories(at("no_state"));
  expectRefusal("dyslam", "--resume -o " + at("no_state"), {"no_state: nothing to resume"});
}

TEST_F(BadInput, WordsOfTheCommandLine)
{
  const std::string out = " -o " + at("never.rawlog");
  expectRefusal("dyslam-eval", "foo", {"unknown command 'foo'"});
  expectRefusal("dyslam-eval", "trak", {"unknown command 'trak'", "did you mean 'tracks'?"});
  expectRefusal("kitti2rawlog", "--kind foo -i " + at("") + out,
                {"unknown word 'foo' (one of: odometry, raw, tracking)"});
  expectRefusal("kitti2rawlog", "--kind 1 -i " + at("") + out, {"unknown word '1'"});
  expectRefusal("kitti2rawlog", "--kind odometry --sequence 0000 -i " + at("") + out,
                {"--sequence goes with --kind tracking"});
  expectRefusal("dyslam", "-i x -o " + at("never") + " --lables",
                {"unknown option '--lables'", "did you mean '--labels'?"});
  expectRefusal("dyslam", "x.rawlog -o " + at("never"), {"x.rawlog: not expected", "--input"});
  for (const std::string pose : {"0.5 0 1.7 -90 0 0", "0.5 -1 1.7 0 0 0"})
  {
    expectRefusal("dyslam", "-i x.mcap -o " + at("never") + " --sensor-pose " + pose,
                  {"not expected", "--sensor-pose stand in quotes: 'x y z yaw pitch roll'"});
  }
  expectRefusal("dyslam", "-i x -o " + at("never") + " --set map.voxel_size=0.1 map.min_hits=2",
                {"map.min_hits=2: not expected; each setting has a --set of its own"});
  expectRefusal("dyslam-map", "-i x --trajectory t -o a.pcd -o ./a.pcd", {"is given twice"});
  expectRefusal("dyslam", "-i x --skip-first-n -3 -o " + at("never"),
                {"'-3' is not a number of 0 or more"});
  expectRefusal("dyslam", "-i x --only-first-n 1.5 -o " + at("never"),
                {"--only-first-n 1.5: is not a whole number"});
  expectRefusal("dyslam-eval", "kitti-slam --data " + at("") + " --modes full odometry full",
                {"--modes: 'full' is given twice"});
  expectRefusal("dyslam", "-i " + write("a.pcap", "x") + " -o " + at("never"),
                {"a.pcap: is not a network capture"});
  expectRefusal("dyslam-eval", "run --truth /nope " + at(""), {"/nope: is not a folder"});
  const std::string box = write("tracks.txt", "0 1 Car 0 0 0 0 0 0 0 1.5 1.8 4 10 2 0 0\n");
  const std::string tracks = "tracks --reference " + box + " --estimate " + box;
  expectRefusal("dyslam-eval", tracks + " --class Truckk",
                {"unknown class 'Truckk'", "Pedestrian", "did you mean 'Truck'?"});
  expectRefusal("dyslam-eval", tracks + " --distance nan", {"--distance nan: is not a number"});
  EXPECT_EQ(run("dyslam-eval", tracks + " --class Car").code, 0);
  write("tracked/tracks.txt", "0 1 Car 0 0 0 0 0 0 0 1.5 1.8 4 10 2 0 0\n");
  write("tracked/tracks.csv", "frame,stamp,id,class,speed,score\n0,,1,,2.5,\n0,0,2,Car,,1\n");
  const Outcome empty_fields =
      run("dyslam-eval", "tracks --reference " + box + " --estimate " + at("tracked"));
  EXPECT_EQ(empty_fields.code, 0) << empty_fields.err;
  expectRefusal("dyslam-eval", "mask /nope.csv", {"/nope.csv: no such file", "--mask-csv"});
  expectRefusal("dyslam-eval", "mask " + write("log.csv", "step,loss\n1,2\n"),
                {"log.csv: the first line must be x,y,z,static_confidence,label"});
  const std::string mask = write("mask.csv", "x,y,z,static_confidence,label\n1,2,3,0.5,2\n");
  EXPECT_EQ(run("dyslam-eval", "mask " + mask).code, 0);
  EXPECT_TRUE(fs::exists(at("mask.png")));
}

TEST_F(BadInput, Trajectories)
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

TEST_F(BadInput, MapsOfPosesAndLabelsThatDoNotFit)
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
                {"000004.label: has 1 labels"});
  expectRefusal("dyslam-map",
                part + " --labelled-map " + at("ref") + " --labels " + at("no_labels"),
                {"ref: the ending is none of .ply"});
  expectRefusal("dyslam-map", part + " --labelled-map " + at("ref.ply"),
                {"ref.ply", "give --labels or --tracks"});
  EXPECT_FALSE(fs::exists(at("never.pcd")));
}

TEST_F(BadInput, FoldersOfRuns)
{
  expectRefusal("dyslam-eval", "run " + at("none"), {"none: is not a folder"});
  expectRefusal("dyslam-eval", "run " + at("file"), {"file: is not a folder"});
  fs::create_directories(at("bare"));
  expectRefusal("dyslam-eval", "run " + at("bare"), {"has no trajectory_tum.txt"});
  write("odd/trajectory_tum.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  write("odd/report.json", "{ \"frames\": ");
  expectRefusal("dyslam-eval", "run " + at("odd"), {"report.json: is not the JSON report"});
  // A report that another program wrote may hold anything.
  write("odd/report.json",
        R"({"frames": "x", "stage_ms": {"a": "b", "c": 2.5}, "input": 4, "ms_per_scan": null})");
  const Outcome outcome = run("dyslam-eval", "run " + at("odd"));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("2.50"), std::string::npos) << outcome.out;
  write("x.gt/poses_tum.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n");
  const Outcome with_truth = run("dyslam-eval", "run " + at("odd") + " --truth " + at("x.gt"));
  EXPECT_EQ(with_truth.code, 0) << with_truth.err;
  EXPECT_EQ(with_truth.err.find("no errors computed"), std::string::npos) << with_truth.err;
  EXPECT_NE(with_truth.out.find("1.0000"), std::string::npos)
      << with_truth.out;  // ratio of the forward motion
  write("odd/report.json", R"({"stage_ms": 3})");
  EXPECT_EQ(run("dyslam-eval", "run " + at("odd")).code, 0);
}

TEST_F(BadInput, FoldersOfLabels)
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
}

TEST_F(BadInput, ScansToConvert)
{
  fs::create_directories(at("none_inside"));
  const std::string out = " -o " + at("never.rawlog");
  expectRefusal("scans2rawlog", "-i " + at("none") + out, {"none: no such file or folder"});
  expectRefusal("scans2rawlog", "-i " + at("none_inside") + out, {"has no .bin, .pcd or .ply"});
  expectRefusal("scans2rawlog", "-i " + at("empty") + out,
                {"empty: ", "give a folder, .pcap, .bag, .db3 or .mcap"});
  expectRefusal("scans2rawlog", "-i " + at("good.rawlog") + out,
                {"good.rawlog: ends in .rawlog: dyslam reads rawlogs as they are"});
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
