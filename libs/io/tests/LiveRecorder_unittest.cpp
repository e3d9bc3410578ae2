// SPDX-License-Identifier: BSD-3-Clause
// Recordings of a lidar on the network, by datagrams on this computer.
#include <dyslam/base/Error.h>
#include <dyslam/io/LiveRecorder.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "SyntheticCapture.h"
#include "SyntheticScans.h"
#include "TestFolder.h"
#include "UdpSender.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr const char* any_port = "udp:127.0.0.1:0";
constexpr double datagram_time = 12 * 2 * 55.296e-6;  // of captured() [s]

/** A lidar that sends packets, a second of them in a quarter of a second, from when a recording
 * listens until the end of the object. */
class SendingLidar
{
 public:
  /** \param packet datagram number n */
  explicit SendingLidar(std::string (*packet)(std::size_t n)) : packet_(packet) {}
  ~SendingLidar()
  {
    stop_ = true;
    if (thread_.joinable())
    {
      thread_.join();
    }
  }
  SendingLidar(const SendingLidar&) = delete;
  SendingLidar& operator=(const SendingLidar&) = delete;

  /** \param name of the receiver: "udp:127.0.0.1:40000" */
  void begin(const std::string& name)
  {
    const auto port = static_cast<std::uint16_t>(std::stoi(name.substr(name.rfind(':') + 1)));
    thread_ = std::thread(
        [this, port]
        {
          const test::UdpSender sender;
          for (std::size_t n = 0; !stop_; ++n)
          {
            sender.send(packet_(n), port);
            ::usleep(static_cast<useconds_t>(1e6 * datagram_time / 4));
          }
        });
  }

 private:
  std::string (*packet_)(std::size_t n);
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

std::string velodyneDatagram(std::size_t n)
{
  return velodynePacket(static_cast<double>(n) * datagram_time);
}

std::string unknownDatagram(std::size_t)
{
  return std::string(500, 'x');
}

class LiveRecorder : public ::testing::Test
{
 protected:
  /** Records until there are `scans`. */
  ConversionResult record(std::string (*packet)(std::size_t n), std::size_t scans)
  {
    SendingLidar lidar(packet);
    LiveRecorderHooks hooks;
    hooks.listening = [&lidar](const std::string& name) { lidar.begin(name); };
    hooks.recorded = [this](std::size_t count)
    {
      recorded_ = count;
      whole_ = whole_ && readCopy().size() == count;
    };
    hooks.stop = [this, scans] { return recorded_ >= scans; };
    return recordLive(any_port, path_, options_, hooks);
  }
  /** The error of a recording that should not begin. */
  std::string refused()
  {
    return messageOfError<UserError>([this] { (void)record(velodyneDatagram, 1); });
  }
  /** The error of a recording that is stopped that long after it listens. */
  std::string stoppedAfter(double seconds)
  {
    using Clock = std::chrono::steady_clock;
    SendingLidar lidar(velodyneDatagram);
    std::atomic<Clock::time_point> end = Clock::time_point::max();
    LiveRecorderHooks hooks;
    hooks.listening = [&](const std::string& name)
    {
      lidar.begin(name);
      end = Clock::now() +
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    };
    hooks.stop = [&] { return Clock::now() > end.load(); };
    return messageOfError<UserError>([&] { (void)recordLive(any_port, path_, options_, hooks); });
  }
  [[nodiscard]] std::vector<Frame> readCopy() const
  {
    fs::copy_file(path_, folder_.file("copy.rawlog"), fs::copy_options::overwrite_existing);
    return readAll(folder_.file("copy.rawlog"));
  }

  TestFolder folder_;
  std::string path_ = folder_.file("a.rawlog");
  ScanConverterOptions options_;
  std::atomic<std::size_t> recorded_ = 0;
  bool whole_ = true;  //!< every scan was in the file when it was told
};
}  // namespace

TEST_F(LiveRecorder, WritesEachScanAsItComes)
{
  options_.sensor_pose = "0 0 1.5 0 0 0";
  const ConversionResult result = record(velodyneDatagram, 4);
  EXPECT_TRUE(whole_);
  EXPECT_LE(4U, result.scans);
  const auto frames = readAll(path_);
  ASSERT_EQ(result.scans, frames.size());

  // The same packets in a capture; the last revolution differs, as it was cut short.
  const std::string capture = folder_.write("a.pcap", captured(800));
  (void)convertScans(capture, folder_.file("b.rawlog"), options_);
  const auto expected = readAll(folder_.file("b.rawlog"));
  for (std::size_t i = 0; i < std::min<std::size_t>(4, expected.size()); ++i)
  {
    EXPECT_TRUE(samePoints(expected[i].scan, frames[i].scan)) << i;
    EXPECT_NEAR(1.5, frames[i].scan.T_vehicle_lidar.translation().z(), 1e-6);
    EXPECT_NEAR(expected[i].scan.stamp - expected[0].scan.stamp,
                frames[i].scan.stamp - frames[0].scan.stamp, 1e-4);
  }
}

TEST_F(LiveRecorder, EndsAfterTheScansThatAreAskedFor)
{
  options_.only_first_n = 3;
  EXPECT_EQ(3U, record(velodyneDatagram, 1000).scans);
  EXPECT_EQ(3U, readAll(path_).size());
}

TEST_F(LiveRecorder, ReplacesARecordingOnlyWithAScan)
{
  writeScans(path_, 2);
  folder_.write("a.gt/poses_tum.txt", "0 0 0 0 0 0 0 1\n");
  const auto expectKept = [this](const std::string& says, const std::string& message)
  {
    EXPECT_TRUE(contains(message, says)) << message;
    EXPECT_EQ(2U, readAll(path_).size()) << says;
    EXPECT_TRUE(fs::exists(folder_.file("a.gt/poses_tum.txt"))) << says;
  };
  expectKept(": has no data packets of a Velodyne",
             messageOfError<UserError>([this] { (void)record(unknownDatagram, 1); }));
  options_.imu = true;
  expectKept("--imu reads the IMU of an Ouster", refused());
  options_.imu = false;
  options_.skip_first_n = 1000;
  expectKept(": stopped before the first scan", stoppedAfter(1.0));
  options_.skip_first_n = 0;
  expectKept(": stopped before the first scan", stoppedAfter(0.02));  // within a revolution
  options_.only_first_n = 1;
  (void)record(velodyneDatagram, 1000);
  EXPECT_EQ(1U, readAll(path_).size());
  EXPECT_FALSE(fs::exists(folder_.file("a.gt/poses_tum.txt")));
}

TEST_F(LiveRecorder, CanBeStoppedBeforeTheFirstScan)
{
  LiveRecorderHooks hooks;
  hooks.stop = [] { return true; };
  EXPECT_EQ(std::string(any_port) + ": stopped before the first scan",
            messageOfError<UserError>([&] { (void)recordLive(any_port, path_, options_, hooks); }));
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(LiveRecorder, RefusesOptionsOfOtherInputs)
{
  options_.dt = 0.1;
  EXPECT_TRUE(contains(refused(), "--dt: the scans of a bag and live ones have times"));
  options_ = {};
  options_.topic = "/points";
  EXPECT_EQ("--topic works with a bag or topics of ROS 2 only", refused());
  options_ = {};
  options_.external_storage = true;
  EXPECT_EQ("--external-storage does not work with a lidar on the network", refused());
  options_ = {};
  options_.imu = true;
  EXPECT_TRUE(contains(refused(), "--imu reads the IMU of an Ouster, and this is a VLP16"));
  EXPECT_TRUE(contains(
      messageOfError<UserError>([this]
                                { (void)convertScans("udp:2368", path_, ScanConverterOptions()); }),
      "udp:2368: is live, not a recording"));
}
}  // namespace dyslam
