// SPDX-License-Identifier: BSD-3-Clause
// No program overwrites its input or files that other programs wrote.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "RunProgram.h"
#include "SyntheticCapture.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
const std::string recording = std::string(DYSLAM_SOURCE_DIR) + "/rawlog/campus16.rawlog";

/** Expects an error. \param says parts of the only line on stderr */
void expectRefusal(const TestFolder& folder,
                   const std::string& program,
                   const std::string& arguments,
                   const std::vector<std::string>& says)
{
  const Outcome outcome = runProgram(program, arguments, folder.path());
  const std::string shown = program + " " + arguments + "\n" + outcome.err;
  EXPECT_EQ(1, outcome.code) << shown;
  EXPECT_EQ(1, std::count(outcome.err.begin(), outcome.err.end(), '\n')) << shown;
  for (const std::string& part : says)
  {
    EXPECT_TRUE(contains(outcome.err, part)) << part << "\nnot in\n" << shown;
  }
}

std::string slam(const std::string& output)
{
  return "-v ERROR -i " + recording + " --only-first-n 2 -o " + output + " ";
}
}  // namespace

TEST(OutputSafety, ARunLeavesATruthFolderAlone)
{
  const TestFolder folder;
  fs::create_directories(folder.file("x.gt/labels"));
  folder.write("x.gt/tracks.txt", "the truth");
  folder.write("x.gt/labels/000000.label", "the truth");
  expectRefusal(folder, "dyslam", slam(folder.file("x.gt")) + "--labels",
                {"x.gt: has files that no run wrote", "tracks.txt, labels", "--force"});
  EXPECT_EQ("the truth", folder.read("x.gt/tracks.txt"));
  EXPECT_EQ("the truth", folder.read("x.gt/labels/000000.label"));
  EXPECT_EQ(0, runProgram("dyslam", slam(folder.file("x.gt")) + "--force", folder.path()).code);
}

TEST(OutputSafety, LabelsThatARunReadsStay)
{
  const TestFolder folder;
  const std::string run = slam(folder.file("run")) + "--labels";
  ASSERT_EQ(0, runProgram("dyslam", run, folder.path()).code);
  expectRefusal(folder, "dyslam", run + " --set dyseg.labels=" + folder.file("run"),
                {"run/labels: would be replaced by this run's labels"});
  EXPECT_TRUE(fs::exists(folder.file("run/labels/000001.label")));

  fs::create_directories(folder.file("run/first_pass/labels"));
  folder.write("run/first_pass/labels/000007.label", "of an earlier run");
  folder.write("run/first_pass/labels/notes.txt", "mine");
  ASSERT_EQ(0, runProgram("dyslam", run + " --passes 2", folder.path()).code);
  EXPECT_FALSE(fs::exists(folder.file("run/first_pass/labels/000007.label")));
  EXPECT_EQ("mine", folder.read("run/first_pass/labels/notes.txt"));
  EXPECT_TRUE(fs::exists(folder.file("run/labels/000001.label")));
  EXPECT_TRUE(fs::exists(folder.file("run/first_pass/labels/000001.label")));
  EXPECT_TRUE(contains(folder.read("run/effective.ini"), "run/first_pass/labels"));
}

TEST(OutputSafety, ASecondRunWaitsOutside)
{
  const TestFolder folder;
  fs::create_directories(folder.file("run"));
  const int held = ::open(folder.file("run/.dyslam.lock").c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_EQ(0, ::flock(held, LOCK_EX));
  expectRefusal(folder, "dyslam", slam(folder.file("run")), {"run: another run is writing to it"});
  ::close(held);
  EXPECT_EQ(0, runProgram("dyslam", slam(folder.file("run")), folder.path()).code);
  EXPECT_FALSE(fs::exists(folder.file("run/.dyslam.lock")));
}

TEST(OutputSafety, LinksAreNotFollowed)
{
  const TestFolder folder;
  fs::create_directories(folder.file("mine"));
  folder.write("mine/000000.label", "mine");
  ASSERT_EQ(0, runProgram("dyslam", slam(folder.file("run")), folder.path()).code);
  fs::create_directory_symlink(folder.file("mine"), folder.file("run/labels"));
  expectRefusal(folder, "dyslam", slam(folder.file("run")), {"labels: is a link"});
  fs::remove(folder.file("run/labels"));
  fs::create_directories(folder.file("run/first_pass"));
  fs::create_directory_symlink(folder.file("mine"), folder.file("run/first_pass/labels"));
  expectRefusal(folder, "dyslam", slam(folder.file("run")) + "--passes 2", {"labels: is a link"});
  fs::create_directories(folder.file("in"));
  folder.write("in/0.bin", std::string(3200, '\0'));
  fs::create_directories(folder.file("k.gt"));
  fs::create_directory_symlink(folder.file("mine"), folder.file("k.gt/labels"));
  expectRefusal(folder, "scans2rawlog",
                "-q --force -i " + folder.file("in") + " -o " + folder.file("k.rawlog"),
                {"labels: is a link"});
  EXPECT_EQ("mine", folder.read("mine/000000.label"));
}

TEST(OutputSafety, NoRunReplacesItsInputs)
{
  const TestFolder folder;
  ASSERT_EQ(0, runProgram("dyslam", slam(folder.file("run")), folder.path()).code);
  const std::string ini = folder.file("run/effective.ini");
  const std::string before = contentOf(ini);
  expectRefusal(folder, "dyslam", slam(folder.file("run")) + "-c " + ini, {"would be replaced"});
  expectRefusal(folder, "dyslam", slam(folder.file("new")) + "-c " + ini + " --profile " + ini,
                {"is an input, too (--config)", "--profile"});
  EXPECT_EQ(before, contentOf(ini));
}

TEST(OutputSafety, NoTableReplacesAnInput)
{
  const TestFolder folder;
  const std::string poses = "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n";
  const std::string a = folder.write("a.txt", poses);
  const std::string b = folder.write("b.txt", poses);
  for (const char* flag : {"--csv", "--json", "--markdown", "--plot"})
  {
    expectRefusal(folder, "dyslam-eval",
                  "trajectory --reference " + a + " --estimate " + b + " " + flag + " " + b,
                  {"b.txt: is an input, too (--estimate)", flag});
  }
  EXPECT_EQ(poses, folder.read("b.txt"));
}

TEST(OutputSafety, NoMapReplacesAnInput)
{
  const TestFolder folder;
  const std::string trajectory = folder.write("t.txt", "1 0 0 0 0 0 0 1\n");
  const std::string tracks = folder.write("tracks.txt", "0 1 Car\n");
  const std::string map = "-i " + recording + " --trajectory " + trajectory + " --tracks " + tracks;
  for (const char* flag : {"--output", "--picture", "--compare", "--labelled-map"})
  {
    for (const auto& [option, input] :
         {std::pair("--trajectory", trajectory), std::pair("--tracks", tracks)})
    {
      expectRefusal(folder, "dyslam-map", map + " " + flag + " " + input,
                    {input + ": is an input, too (" + option + "); choose another " + flag});
    }
  }
  const std::string poses = folder.write("m_tum.txt", "1 0 0 0 0 0 0 1\n");
  expectRefusal(folder, "dyslam-map",
                "-i " + recording + " --trajectory " + poses + " --map-pose '1 2 3 0 0 0' -o " +
                    folder.file("m.pcd"),
                {"m_tum.txt: would be replaced by its poses in the frame of --map-pose"});
  EXPECT_EQ("1 0 0 0 0 0 0 1\n", folder.read("m_tum.txt"));
  EXPECT_EQ("1 0 0 0 0 0 0 1\n", folder.read("t.txt"));
  EXPECT_EQ("0 1 Car\n", folder.read("tracks.txt"));
}

TEST(OutputSafety, NoEvaluationReplacesAnInput)
{
  const TestFolder folder;
  const std::string table = folder.write("t.md", "mine");
  expectRefusal(folder, "dyslam-eval", "tables " + table + " --markdown " + table,
                {"t.md: is an input, too (runs); choose another --markdown"});
  expectRefusal(folder, "dyslam-eval",
                "speeds --data " + folder.path() + " --sequence 0 --track 1 --series a=" + table +
                    " --csv " + table,
                {"t.md: is an input, too (--series); choose another --csv"});
  EXPECT_EQ("mine", folder.read("t.md"));
}

TEST(OutputSafety, NoFileIsWrittenTwice)
{
  const TestFolder folder;
  const std::string picture = folder.write("x.png", "of an earlier map");
  const std::string same = folder.file("./x.png");
  const std::string map = "-i " + recording + " --trajectory t.txt ";
  expectRefusal(folder, "dyslam-map", map + "--picture " + picture + " --output " + same,
                {"x.png: is given twice as a file to write (--output and --picture)"});
  expectRefusal(folder, "dyslam-map", map + "--output " + picture + " --output " + same,
                {"x.png: is given twice as a file to write (--output)"});
  const std::string made = folder.file("new.txt");
  expectRefusal(folder, "dyslam-eval",
                "trajectory --estimate " + picture + " --csv " + made + " --json " + made,
                {"new.txt: is given twice as a file to write (--json and --csv)"});
  EXPECT_EQ("of an earlier map", folder.read("x.png"));
}

TEST(OutputSafety, NoConversionReplacesItsInputs)
{
  const TestFolder folder;
  const std::string capture = captured(200);
  folder.write("a.pcap", capture);
  fs::create_symlink(folder.file("a.pcap"), folder.file("b.pcap"));
  for (const char* output : {"a.pcap", "./a.pcap"})
  {
    expectRefusal(folder, "scans2rawlog",
                  "-q -i " + folder.file("a.pcap") + " -o " + folder.file(output),
                  {"a.pcap: is an input, too (--input)", "--output"});
  }
  expectRefusal(folder, "scans2rawlog",
                "-q -i " + folder.file("a.pcap") + " -o " + folder.file("b.pcap"), {"is an input"});
  EXPECT_EQ(capture, folder.read("a.pcap"));

  fs::create_directories(folder.file("k/velodyne"));
  fs::create_directories(folder.file("k.gt/labels"));
  folder.write("k/velodyne/000000.bin", std::string(160, '\0'));
  folder.write("k.gt/labels/000000.label", std::string(40, '\x09'));
  expectRefusal(folder, "kitti2rawlog",
                "-q --force --kind odometry -i " + folder.file("k") + " --labels " +
                    folder.file("k.gt/labels") + " -o " + folder.file("k.rawlog"),
                {"k.gt/labels: would be replaced"});
  EXPECT_EQ(std::string(40, '\x09'), folder.read("k.gt/labels/000000.label"));
  EXPECT_FALSE(fs::exists(folder.file("k.rawlog")));
}

TEST(OutputSafety, TheCheckpointOfAKilledRunIsNotLostByAccident)
{
  const TestFolder folder;
  folder.write("run/resume.state", "of hours");
  expectRefusal(folder, "dyslam", slam(folder.file("run")), {"--resume", "--force"});
  EXPECT_EQ("of hours", folder.read("run/resume.state"));
}

TEST(OutputSafety, RecordingsAreReplacedOnlyWithForce)
{
  const TestFolder folder;
  fs::create_directories(folder.file("in"));
  folder.write("in/0.bin", std::string(3200, '\1'));
  folder.write("x.gt/notes.txt", "mine");
  const std::string convert = "-q -i " + folder.file("in") + " -o " + folder.file("x.rawlog");
  expectRefusal(folder, "scans2rawlog", convert, {"x.gt: is there already", "--force"});
  const std::string simulate =
      "-q --sensor VLP16 --columns 100 --seconds 0.1 -o " + folder.file("x.rawlog");
  expectRefusal(folder, "dyslam-sim", simulate, {"x.gt: is there already", "--force"});
  EXPECT_EQ("mine", folder.read("x.gt/notes.txt"));
  EXPECT_EQ(0, runProgram("dyslam-sim", "--force " + simulate, folder.path()).code);
  expectRefusal(folder, "scans2rawlog", convert, {"x.rawlog: is there already"});
}

TEST(OutputSafety, AConversionThatFailsLeavesTheEarlierOne)
{
  const TestFolder folder;
  fs::create_directories(folder.file("in"));
  folder.write("in/0.bin", std::string(3200, '\0'));
  const std::string convert = "-q --force --external-storage -i " + folder.file("in") + " -o " +
                              folder.file("x.rawlog") + " --poses " + folder.file("poses.txt");
  folder.write("poses.txt", "1 0 0 5 0 1 0 0 0 0 1 0\n");
  ASSERT_EQ(0, runProgram("scans2rawlog", convert, folder.path()).code);
  const std::string rawlog = folder.read("x.rawlog");
  const std::string truth = folder.read("x.gt/poses_tum.txt");
  const std::string cloud = folder.read("x_Images/lidar_000000.gz");
  ASSERT_FALSE(rawlog.empty() || truth.empty() || cloud.empty());
  folder.write("in/0.bin", "cut");
  EXPECT_EQ(1, runProgram("scans2rawlog", convert, folder.path()).code);
  EXPECT_EQ(rawlog, folder.read("x.rawlog"));
  EXPECT_EQ(truth, folder.read("x.gt/poses_tum.txt"));
  EXPECT_EQ(cloud, folder.read("x_Images/lidar_000000.gz"));
  for (const char* leftover : {"x.rawlog.tmp", "x.gt.tmp", "x_Images.tmp"})
  {
    EXPECT_FALSE(fs::exists(folder.file(leftover))) << leftover;
  }
}
}  // namespace dyslam
