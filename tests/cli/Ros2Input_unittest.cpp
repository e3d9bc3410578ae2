// SPDX-License-Identifier: BSD-3-Clause
// dyslam and scans2rawlog on live topics of ROS 2, published here: a simulated VLP-16 on a vehicle
// with an IMU, as Velodyne's driver publishes it. The domain is that of the test alone.
#include <dyslam/formats/RosMessages.h>
#include <dyslam/formats/RosWriter.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/sim/Simulator.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "BackgroundProgram.h"
#include "Ros2Members.h"
#include "RunProgram.h"
#include "SimulatedPackets.h"
#include "TestFolder.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr double turn = 0.1;     //!< of the lidar [s]
constexpr int imu_samples = 10;  //!< in a turn

class Ros2Input : public ::testing::Test
{
 protected:
  static void SetUpTestSuite()
  {
    test::setOwnDomain();
    sim::SimulatorOptions options = test::SimulatedPackets::options();
    options.seed = 5;
    sim::Simulator simulator(options, 1);
    const double begin =
        std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    for (std::size_t i = 0; i < scans; ++i)
    {
      Scan scan = simulator.next().scan;
      scan.stamp = begin + turn * static_cast<double>(i);
      clouds_.push_back(cloudMessage(scan, "velodyne"));
      rear_clouds_.push_back(cloudMessage(scan, "rear"));
      stamps_.push_back(scan.stamp);
    }
  }
  static void TearDownTestSuite()
  {
    clouds_.clear();
    rear_clouds_.clear();
    stamps_.clear();
  }

  Ros2Input()
  {
    points_ = domain_->advertise({"/velodyne_points", "sensor_msgs/PointCloud2", false, false, 5});
    imu_ = domain_->advertise({"/imu", "sensor_msgs/Imu", false, false, 50});
    transforms_ = domain_->advertise({"/tf_static", "tf2_msgs/TFMessage", true, true, 1});
    RosPose lidar{stamps_.front(), "base_link", "velodyne", Pose::Identity()};
    lidar.pose.translation().z() = 1.5;
    RosPose rear = lidar;
    rear.child = "rear";
    rear.pose.translation().x() = -2;
    transforms_->publish(transformsMessage({lidar, rear}));
  }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] Outcome run(const std::string& program, const std::string& arguments) const
  {
    return runProgram(program, arguments, folder_.path());
  }
  /** Waits until the program receives the scans. */
  void listen(BackgroundProgram& program)
  {
    ASSERT_TRUE(program.waitUntil([this] { return points_->subscriptions() > 0; }))
        << program.said();
  }
  /** What a topic has, of the messages so far. */
  [[nodiscard]] std::vector<std::string> received(const std::string& topic)
  {
    Ros2Message message;
    while (domain_->receive(message, std::chrono::milliseconds(0)))
    {
      received_[message.topic].push_back(message.data);
    }
    return received_[topic];
  }
  /** Sends scans at twice the pace of the lidar, and what the IMU measures meanwhile. */
  void send(std::size_t from, std::size_t to)
  {
    for (std::size_t i = from; i < to; ++i)
    {
      points_->publish(clouds_[i]);
      for (int k = 0; k < imu_samples; ++k)
      {
        RosImu sample;
        sample.stamp = stamps_[i] + turn * k / imu_samples;
        sample.frame = "base_link";
        sample.acceleration = Eigen::Vector3d(0, 0, 9.81);
        imu_->publish(imuMessage(sample));
        ::usleep(static_cast<useconds_t>(1e6 * turn / imu_samples / 2));
      }
    }
  }
  /** Expects that a later run on the recording gives the same. */
  void expectSameLater(const std::string& live)
  {
    const Outcome later =
        run("dyslam", "-q -i " + at(live + "/recording.rawlog") + " -o " + at("later"));
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
    EXPECT_TRUE(contains(outcome.err, says)) << outcome.err;
    EXPECT_FALSE(fs::exists(at("never")));
  }

  static constexpr std::size_t scans = 40;
  static std::vector<std::string> clouds_;
  static std::vector<std::string> rear_clouds_;  //!< the same, of another lidar
  static std::vector<double> stamps_;            //!< [s]
  TestFolder folder_;
  std::unique_ptr<Ros2Domain> domain_ = test::joinOwnDomain();
  std::map<std::string, std::vector<std::string>> received_;  //!< by topic
  std::unique_ptr<Ros2Publisher> points_;
  std::unique_ptr<Ros2Publisher> imu_;
  std::unique_ptr<Ros2Publisher> transforms_;
};
std::vector<std::string> Ros2Input::clouds_;
std::vector<std::string> Ros2Input::rear_clouds_;
std::vector<double> Ros2Input::stamps_;
}  // namespace

TEST_F(Ros2Input, ARunUntilCtrlCIsThatOfItsRecording)
{
  BackgroundProgram live({"dyslam", "-i", "ros2:/velodyne_points", "-o", at("live"), "--imu-topic",
                          "/imu", "--base-frame", "base_link"},
                         at("out"), at("err"));
  listen(live);
  send(0, scans);
  ASSERT_TRUE(live.waitUntil([this] { return fs::exists(at("live/recording.rawlog")); }));
  live.signal(SIGINT);
  EXPECT_EQ(0, live.wait()) << live.said();
  const std::string said = folder_.read("out") + live.said();
  for (const std::string expected :
       {"waits for messages of /velodyne_points (ROS 2, domain ", "scans: /velodyne_points",
        "the vehicle is base_link, in which /tf_static places the lidar", "IMU: /imu, ",
        "per-point time: field time"})
  {
    EXPECT_TRUE(contains(said, expected)) << expected << '\n' << said;
  }
  EXPECT_TRUE(contains(folder_.read("live/recording.ini"), "input = ros2:/velodyne_points"));
  EXPECT_TRUE(contains(folder_.read("live/report.json"), "\"finished\": true"));
  expectSameLater("live");
  expectRefused("dyslam", "-i ros2: -o " + at("live"),
                "recording.rawlog: is there already; choose another --output");
}

TEST_F(Ros2Input, ARunIsPublishedWhileItGoesOn)
{
  const std::vector<std::pair<std::string, std::string>> published{
      {"/tf", "tf2_msgs/TFMessage"},
      {"/dyslam/odometry", "nav_msgs/Odometry"},
      {"/dyslam/points_static", "sensor_msgs/PointCloud2"},
      {"/dyslam/objects", "visualization_msgs/MarkerArray"}};
  for (const auto& [topic, type] : published)
  {
    domain_->subscribe(topic);
  }
  BackgroundProgram live({"dyslam", "-i", "ros2:", "--publish", "-o", at("live")}, at("out"),
                         at("err"));
  listen(live);
  send(0, scans);
  ASSERT_TRUE(live.waitUntil([this] { return received("/dyslam/odometry").size() > 20; }))
      << live.said();  // while it goes on
  live.signal(SIGINT);
  EXPECT_EQ(0, live.wait()) << live.said();

  const Trajectory trajectory = readTum(at("live/trajectory_tum.txt"));
  ASSERT_TRUE(
      test::waitUntil([&] { return received("/dyslam/odometry").size() == trajectory.size(); }));
  for (const auto& [topic, type] : published)
  {
    EXPECT_LE(trajectory.size() - 2, received(topic).size()) << topic;
    BagTopic of_message;
    of_message.name = topic;
    of_message.type = type;
    of_message.encoding = RosEncoding::cdr;
    const std::string data = received(topic).back();
    const BagMessage message{0, 0, data, "last"};
    if (isRosPose(of_message))
    {
      const RosPose pose = decodeRosPoses(of_message, message).at(0);
      EXPECT_EQ("map", pose.parent);
      EXPECT_EQ("velodyne", pose.child);  // the vehicle is the lidar
      const StampedPose& last = trajectory[trajectory.size() - 1];
      EXPECT_NEAR(last.stamp, pose.stamp, 1e-6);
      EXPECT_LT((last.pose.translation() - pose.pose.translation()).norm(), 0.05) << topic;
    }
    else if (RosScanDecoder::reads(of_message))
    {
      EXPECT_LT(1000U, RosScanDecoder().decode(of_message, message).size());
    }
  }
}

TEST_F(Ros2Input, TheScansOfADomainAreFoundAndListed)
{
  BackgroundProgram list({"scans2rawlog", "-i", "ros2:", "--list"}, at("list"), at("err"));
  listen(list);
  send(0, 10);
  EXPECT_EQ(0, list.wait()) << list.said();
  const std::string table = folder_.read("list");
  EXPECT_TRUE(contains(table, "velodyne  <- taken without --topic")) << table;
  EXPECT_TRUE(contains(table, "-  <- for --imu-topic")) << table;
  EXPECT_TRUE(contains(table, "--sensor-pose '0 0 1.5 0 0 0'  (velodyne in base_link")) << table;

  BackgroundProgram recorder(
      {"scans2rawlog", "-q", "-i", "ros2:", "--only-first-n", "5", "-o", at("a.rawlog")}, at("out"),
      at("err"));
  listen(recorder);
  send(0, scans);
  EXPECT_EQ(0, recorder.wait()) << recorder.said();
  EXPECT_TRUE(contains(folder_.read("out"), "5 scans")) << folder_.read("out");
}

TEST_F(Ros2Input, AllSensorsAreRecorded)
{
  const auto rear = domain_->advertise({"/rear", "sensor_msgs/PointCloud2"});
  const auto wheels = domain_->advertise({"/odom", "geometry_msgs/TwistStamped"});
  const auto receiver = domain_->advertise({"/fix", "sensor_msgs/NavSatFix"});
  BackgroundProgram recorder({"scans2rawlog", "-q", "-i", "ros2:/velodyne_points",
                              "--further-topic", "/rear", "--imu-topic", "/imu", "--odometry-topic",
                              "/odom", "--gnss-topic", "/fix", "-o", at("a.rawlog")},
                             at("out"), at("err"));
  for (const Ros2Publisher* topic : {points_.get(), rear.get(), wheels.get(), receiver.get()})
  {
    ASSERT_TRUE(recorder.waitUntil([&] { return topic->subscriptions() > 0; })) << recorder.said();
  }
  for (std::size_t i = 0; i < scans / 2; ++i)
  {
    RosTwist speed;
    speed.stamp = stamps_[i];
    speed.frame = "base_link";
    speed.linear.x() = 5;
    wheels->publish(twistMessage(speed));
    RosFix fix;
    fix.stamp = stamps_[i];
    fix.position = {49, 8.4, 115};
    receiver->publish(fixMessage(fix));
    rear->publish(rear_clouds_[i]);
    send(i, i + 1);
  }
  ASSERT_TRUE(recorder.waitUntil([this] { return fs::exists(at("a.rawlog")); }));
  recorder.signal(SIGINT);
  EXPECT_EQ(0, recorder.wait()) << recorder.said();
  const std::string said = folder_.read("out") + recorder.said();
  for (const std::string expected :
       {"further lidar: /rear, label rear; dyslam merges", "IMU: /imu, ", "wheel odometry: /odom, ",
        "satellite receiver: /fix, "})
  {
    EXPECT_TRUE(contains(said, expected)) << expected << '\n' << said;
  }
  EXPECT_FALSE(contains(said, "no scan of this further lidar")) << said;
  EXPECT_FALSE(contains(said, "has no sample at the times of the scans")) << said;
}

TEST_F(Ros2Input, BadInputIsRefusedInOneLine)
{
  const std::string out = " -o " + at("never");
  expectRefused("dyslam", "-i ros2:/imu" + out, "--topic /imu: sensor_msgs/Imu is not read");
  expectRefused("dyslam", "-i ros2: --no-tf" + out, "--no-tf requires --publish");
  expectRefused("dyslam", "-i ros2:/a --topic /b" + out, "--topic /b is another topic");
  expectRefused("dyslam", "-i ros2: --dt 0.1" + out, "--dt: the scans of a bag and live ones");
  expectRefused("dyslam", "-i ros2: --set map.nothing=1" + out, "map.nothing");
  expectRefused("scans2rawlog", "-i ros2: --truth-topic /t -o " + at("x.rawlog"),
                "--truth-topic works with a bag only");
  expectRefused("rawlog2bag", "-i ros2: -o " + at("x"), "is live; record it first");
}

TEST_F(Ros2Input, StopsBeforeTheFirstScan)
{
  BackgroundProgram live({"dyslam", "-i", "ros2:", "-o", at("live")}, at("out"), at("err"));
  listen(live);
  live.signal(SIGTERM);
  EXPECT_EQ(1, live.wait());
  EXPECT_TRUE(contains(live.said(), "dyslam: ros2:: stopped before the first scan\n"));
  EXPECT_FALSE(fs::exists(at("live")));
}
}  // namespace dyslam
