// SPDX-License-Identifier: BSD-3-Clause
// Programs with options, settings and output paths that cannot be used.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "RefusedInput.h"
#include "RunProgram.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
class BadArguments : public test::RefusedInput
{
};

TEST_F(BadArguments, OutputsThatCannotBeWritten)
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
  expectRefusal("dyslam-map",
                "-i " + good + " --trajectory " + poses + " -o " + at("m.pcd") +
                    " --set backend.keyframe_distance=0.5",
                {"--set backend.keyframe_distance=0.5: give --keyframe-distance 0.5"});
  fs::create_directories(at("taken.pcd"));
  expectRefusal("dyslam-map", "-i " + good + " --trajectory " + poses + " -o " + at("taken.pcd"),
                {"taken.pcd: is a folder; name the file to write"});
  for (const char* flag : {"--json ", "--csv ", "--markdown ", "--plot "})
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

TEST_F(BadArguments, Configs)
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
  expectRefusal("dyslam-map",
                "-i " + at("good.rawlog") + " --trajectory x -o m.pcd --set map.grid_resolution=1",
                {"[map]: unknown key 'grid_resolution'; 'grid_resolution' is a key of "
                 "[map_export]: --set map_export.grid_resolution=1"});
  expectRefusal("dyslam", start + "--set input.keyframe_distance=1",
                {"[input]: unknown key 'keyframe_distance'; 'keyframe_distance' is a key of "
                 "[backend]: --set backend.keyframe_distance=1"});
  expectRefusal("dyslam-map",
                "-i " + at("good.rawlog") + " --trajectory x -o m.pcd --keyframe-distance 2000",
                {"keyframe_distance = 2000", "out of range"});
  expectRefusal(
      "dyslam-map",
      "-i " + at("good.rawlog") + " --trajectory x -o m.pcd -c vlp16.ini --set mapp.voxel_size=1",
      {"--set mapp.voxel_size=1", "sections map, labels, preprocess"});
  const std::string map = "-i " + at("good.rawlog") + " --trajectory x -o m.pcd -c vlp16.ini ";
  expectRefusal("dyslam-map", map + "--map-pose '1 2 3'",
                {"--map-pose '1 2 3'", "six numbers are needed"});
  expectRefusal("dyslam-map", map + "--map-pose 1 2 3 0 0 0",
                {"the six numbers of --map-pose stand in quotes"});
  expectRefusal("dyslam-map", "--run x -o m.pcd --time-offset 1",
                {"--time-offset", "--trajectory"});
  expectRefusal("dyslam-map", map + "--set odometry.method=dylo",
                {"--set odometry.method=dylo", "the section [odometry] belongs to dyslam"});
  expectRefusal("dyslam-map", map + "--set merge.level_map=true",
                {"the section [merge] is for --merge"});
  expectRefusal("dyslam-map",
                "-i " + at("good.rawlog") + " --trajectory x -o m.pcd -c " +
                    write("bad.ini", "[mapp]\nvoxel_size = 1\n"),
                {"bad.ini:1", "'mapp'", "did you mean 'map'"});
  expectRefusal("dyslam", start + "--start 2 --end 1", {"end = 1 s is not after start = 2 s"});
  expectRefusal("dyslam", start + "--start 999", {"start = 999 s", "the file has 12 scans"});
  EXPECT_FALSE(fs::exists(at("never") + "/trajectory_tum.txt"));
}

TEST_F(BadArguments, NamesThatTheFileSystemRefuses)
{
  const std::string name(300, 'a');
  const std::vector<std::pair<std::string, std::string>> calls{
      {"dyslam", "-o " + at("never") + " -i "},
      {"scans2rawlog", "-o " + at("never.rawlog") + " -i "},
      {"dyslam-map", "-o " + at("never.pcd") + " --run "},
      {"dyslam-eval", "run "}};
  for (const auto& [program, arguments] : calls)
  {
    expectRefusal(program, arguments + at(name), {name + ": File name too long"});
  }
}

TEST_F(BadArguments, FoldersToResume)
{
  expectRefusal("dyslam", "--resume -o " + at("nowhere"),
                {"nowhere: no such folder", "--output names the folder of the run to resume"});
  EXPECT_FALSE(fs::exists(at("nowhere")));
  fs::create_directories(at("no_state"));
  expectRefusal("dyslam", "--resume -o " + at("no_state"), {"no_state: nothing to resume"});
}

TEST_F(BadArguments, WordsOfTheCommandLine)
{
  const std::string out = " -o " + at("never.rawlog");
  expectRefusal("dyslam-eval", "foo", {"unknown command 'foo'"});
  expectRefusal("dyslam-eval", "trak", {"unknown command 'trak'", "did you mean 'tracks'?"});
  expectRefusal("dyslam-eval", "trak --reference x", {"unknown command 'trak'"});
  expectRefusal("dyslam-eval", "--reference x", {"--reference: not expected before the command"});
  expectRefusal("dyslam-eval", "", {"a command is needed (one of: trajectory,"});
  expectRefusal("kitti2rawlog", "--kind foo -i " + at("") + out,
                {"unknown word 'foo' (one of: 360, odometry, raw, tracking)"});
  expectRefusal("kitti2rawlog", "--kind 1 -i " + at("") + out, {"unknown word '1'"});
  expectRefusal("kitti2rawlog", "--kind odometry --sequence 0000 -i " + at("") + out,
                {"--sequence goes with --kind tracking or 360"});
  expectRefusal("dyslam", "-i x -o " + at("never") + " --lables",
                {"unknown option '--lables'", "did you mean '--labels'?"});
  expectRefusal("dyslam", slam(at("good.rawlog"), "y") + " --times t.txt",
                {"unknown option '--times'; scans2rawlog and kitti2rawlog have it: convert"});
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
  expectRefusal("dyslam-eval", "kitti-mot --data " + at("") + " --sequences 0001 0006 0001",
                {"--sequences: '0001' is given twice"});
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
}  // namespace
}  // namespace dyslam
