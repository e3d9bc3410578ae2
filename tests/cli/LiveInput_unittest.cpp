// SPDX-License-Identifier: BSD-3-Clause
// dyslam and scans2rawlog on a lidar on the network: packets of a simulated VLP-16, sent on this
// computer. The system chooses the ports.
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "BackgroundProgram.h"
#include "RunProgram.h"
#include "SimulatedPackets.h"
#include "TestFolder.h"
#include "UdpSender.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr const char* any_port = "udp:127.0.0.1:0";

class LiveInput : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    sim::SimulatorOptions options = test::SimulatedPackets::options();
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    for (std::size_t i = 0; i < scans; ++i)
    {
      packets_.push_back(test::SimulatedPackets::of(simulator.next().scan, i));
    }
  }
  static void TearDownTestSuite() { packets_.clear(); }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] Outcome run(const std::string& program, const std::string& arguments) const
  {
    return runProgram(program, arguments, folder_.path());
  }

  /** Waits until the program receives, and finds its port. */
  void listen(BackgroundProgram& program)
  {
    const std::string mark = "waits for packets on ";
    ASSERT_TRUE(program.waitUntil([&] { return contains(program.said(), mark + "udp:"); }))
        << program.said();
    // The whole line is there, as it is written at once.
    std::string rest = program.said();
    rest.erase(0, rest.find(mark) + mark.size());
    rest.erase(std::min(rest.find_first_of(";\n"), rest.size()));  // "udp:127.0.0.1:40000"
    port_ = static_cast<std::uint16_t>(std::stoi(rest.substr(rest.rfind(':') + 1)));
  }

  /** Sends scans at twice the pace of the lidar. */
  void send(std::size_t from, std::size_t to)
  {
    constexpr auto pause = static_cast<useconds_t>(1e6 * test::SimulatedPackets::turn /
                                                   test::SimulatedPackets::packets_of_scan / 2);
    for (std::size_t i = from; i < to; ++i)
    {
      for (const std::string& packet : packets_[i])
      {
        sender_.send(packet, port_);
        ::usleep(pause);
      }
    }
  }

  /** Expects that a later run on the recording gives the same trajectory. */
  void expectSameLater(const std::string& live, const std::string& flags = "")
  {
    const Outcome later = run(
        "dyslam", "-q " + flags + " -i " + at(live + "/recording.rawlog") + " -o " + at("later"));
    EXPECT_EQ(0, later.code) << later.err;
    const std::string expected = folder_.read("later/trajectory_tum.txt");
    EXPECT_LT(20, std::count(expected.begin(), expected.end(), '\n'));
    EXPECT_EQ(expected, folder_.read(live + "/trajectory_tum.txt"));
    EXPECT_TRUE(folder_.read("later/map_static.pcd") == folder_.read(live + "/map_static.pcd"));
  }

  /** Expects an error, one line. */
  void expectRefused(const std::string& program,
                     const std::string& arguments,
                     const std::string& says)
  {
    const Outcome outcome = run(program, arguments);
    EXPECT_EQ(1, outcome.code) << arguments << '\n' << outcome.err;
    EXPECT_EQ(1, std::count(outcome.err.begin(), outcome.err.end(), '\n')) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, says)) << outcome.err;
  }

  static constexpr std::size_t scans = 32;
  static std::vector<std::vector<std::string>> packets_;  //!< of each scan
  TestFolder folder_;
  test::UdpSender sender_;
  std::uint16_t port_ = 0;
};
std::vector<std::vector<std::string>> LiveInput::packets_;
}  // namespace

TEST_F(LiveInput, ARunUntilCtrlCIsThatOfItsRecording)
{
  BackgroundProgram live({"dyslam", "-i", any_port, "-o", at("live")}, at("out"), at("err"));
  listen(live);
  send(0, scans);
  live.signal(SIGINT);
  EXPECT_EQ(0, live.wait()) << live.said();
  EXPECT_TRUE(contains(folder_.read("out"), "recording.rawlog: ")) << folder_.read("out");
  EXPECT_TRUE(contains(folder_.read("live/recording.ini"), "input = udp:127.0.0.1:"));
  EXPECT_TRUE(contains(folder_.read("live/report.json"), "\"finished\": true"));
  expectSameLater("live");

  // What was received exists nowhere else.
  const std::string before = folder_.read("live/recording.rawlog");
  expectRefused("dyslam", std::string("-i ") + any_port + " -o " + at("live"),
                "recording.rawlog: is there already; choose another --output");
  EXPECT_TRUE(before == folder_.read("live/recording.rawlog"));
}

TEST_F(LiveInput, AKilledRunIsResumedFromWhatWasRecorded)
{
  BackgroundProgram live(
      {"dyslam", "-i", any_port, "-o", at("live"), "--set", "output.checkpoint_seconds=0.2"},
      at("out"), at("err"));
  listen(live);
  send(0, scans);
  EXPECT_TRUE(live.waitUntil([this] { return fs::exists(at("live/resume.state")); }))
      << live.said();
  live.signal(SIGKILL);
  EXPECT_EQ(128 + SIGKILL, live.wait());
  const Outcome resumed = run("dyslam", "--resume -o " + at("live"));
  EXPECT_EQ(0, resumed.code) << resumed.err;
  expectSameLater("live", "--set output.checkpoint_seconds=0.2");
}

TEST_F(LiveInput, TheEndOfTheRunEndsTheRecording)
{
  BackgroundProgram live({"dyslam", "--only-first-n", "5", "-i", any_port, "-o", at("live")},
                         at("out"), at("err"));
  listen(live);
  send(0, scans);
  EXPECT_EQ(0, live.wait()) << live.said();
  const std::string trajectory = folder_.read("live/trajectory_tum.txt");
  EXPECT_EQ(5, std::count(trajectory.begin(), trajectory.end(), '\n'));
}

TEST_F(LiveInput, ARunThatIsStoppedBeforeTheFirstScanLeavesNoFolder)
{
  BackgroundProgram live({"dyslam", "-q", "-i", any_port, "-o", at("quiet")}, at("out"), at("err"));
  ASSERT_TRUE(live.waitUntil([this] { return fs::exists(at("quiet")); }));  // then it waits
  live.signal(SIGTERM);
  EXPECT_EQ(1, live.wait());
  EXPECT_EQ("dyslam: udp:127.0.0.1:0: stopped before the first scan\n", live.said());
  EXPECT_FALSE(fs::exists(at("quiet")));
}

TEST_F(LiveInput, ARunFollowsTheRecordingOfAnotherProgram)
{
  BackgroundProgram recorder({"scans2rawlog", "-i", any_port, "-o", at("live/recording.rawlog")},
                             at("out"), at("err"));
  listen(recorder);
  send(0, 8);
  ASSERT_TRUE(recorder.waitUntil([this] { return fs::exists(at("live/recording.rawlog")); }));
  BackgroundProgram follower({"dyslam", "-i", at("live/recording.rawlog"), "-o", at("live")},
                             at("out2"), at("err2"));
  send(8, scans);
  recorder.signal(SIGINT);
  EXPECT_EQ(0, recorder.wait()) << recorder.said();
  EXPECT_EQ(0, follower.wait()) << follower.said();
  EXPECT_TRUE(contains(follower.said(), "follows " + at("live/recording.rawlog")));
  expectSameLater("live");
}

/** The lidar is quiet then, and the recording goes on. */
TEST_F(LiveInput, ARunThatFollowsIsEndedByCtrlC)
{
  const std::string recording = at("live/recording.rawlog");
  BackgroundProgram recorder({"scans2rawlog", "-i", any_port, "-o", recording}, at("out"),
                             at("err"));
  listen(recorder);
  send(0, scans);
  BackgroundProgram follower({"dyslam", "-i", recording, "-o", at("live")}, at("out2"), at("err2"));
  ASSERT_TRUE(follower.waitUntil([this] { return fs::exists(at("live/motions.csv.tmp")); }));
  ::usleep(500000);  // wherever it is then
  follower.signal(SIGINT);
  EXPECT_EQ(1, follower.wait());
  EXPECT_TRUE(contains(follower.said(), "stopped on request after ")) << follower.said();
  EXPECT_TRUE(contains(folder_.read("live/report.json"), "\"finished\": false"));
  recorder.signal(SIGINT);
  EXPECT_EQ(0, recorder.wait()) << recorder.said();
  const Outcome resumed = run("dyslam", "--resume -o " + at("live"));
  EXPECT_EQ(0, resumed.code) << resumed.err;
  expectSameLater("live");
}

TEST_F(LiveInput, BadInputIsRefusedInOneLine)
{
  const std::string out = " -o " + at("never");
  expectRefused("dyslam", "-i udp:x" + out, "--input udp:x: 'x' is no UDP port: give udp:PORT");
  expectRefused("dyslam", "-i udp:192.0.2.1:0" + out, "192.0.2.1 is no address of this computer");
  expectRefused("dyslam", "-i udp:0 --topic /points" + out,
                "--topic works with a bag or topics of ROS 2 only");
  expectRefused("dyslam", "-i udp:0 --set map.nothing=1" + out, "map.nothing");
  expectRefused("dyslam", "-i udp:0 --resume" + out, "--resume reads the rawlog of the run");
  expectRefused("dyslam", "-i udp:0 --calibration none.csv" + out, "none.csv");
  expectRefused("scans2rawlog", "-i udp:0 --external-storage -o " + at("x.rawlog"),
                "--external-storage does not work with a lidar on the network");
  for (const std::string program :
       {"dyslam-map --trajectory none.txt", "rawlog2kitti", "rawlog2bag"})
  {
    expectRefused(program, "-i udp:2368 -o " + at("x"), "is a lidar on the network");
  }
  expectRefused("dyslam-batch", "udp:2368" + out, "udp:2368");
  EXPECT_FALSE(fs::exists(at("never")));
}

TEST_F(LiveInput, PacketsOfNoLidarAreRefused)
{
  BackgroundProgram live({"dyslam", "-i", any_port, "-o", at("live")}, at("out"), at("err"));
  listen(live);
  for (int i = 0; i < 400; ++i)
  {
    sender_.send(std::string(100, 'x'), port_);
    ::usleep(500);
  }
  EXPECT_EQ(1, live.wait());
  EXPECT_TRUE(contains(live.said(),
                       "has no data packets of a Velodyne (UDP, 1206 bytes) or a Hesai, "
                       "but UDP packets of 100 bytes"))
      << live.said();
  EXPECT_FALSE(fs::exists(at("live")));

  // The port of another program.
  BackgroundProgram first({"scans2rawlog", "-i", any_port, "-o", at("a.rawlog")}, at("out"),
                          at("err"));
  listen(first);
  expectRefused("dyslam", "-i udp:127.0.0.1:" + std::to_string(port_) + " -o " + at("live"),
                "another program receives on UDP port " + std::to_string(port_));
}
}  // namespace dyslam
