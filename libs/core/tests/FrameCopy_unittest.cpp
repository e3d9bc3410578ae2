// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/FrameCopy.h>
#include <gtest/gtest.h>

#include <iterator>
#include <string>
#include <tuple>
#include <vector>

namespace dyslam
{
namespace
{
enum class Kept
{
  no,
  partly,
  yes
};

/** Of each field of Frame, in their order, what copyOf() keeps of it with FrameParts::cloud. */
struct FieldOfFrame
{
  const char* name;
  Kept kept;
};
constexpr FieldOfFrame fields_of_frame[] = {
    {"index", Kept::yes},
    {"scan", Kept::partly},
    {"T_world_vehicle_truth", Kept::yes},
    {"imu", Kept::no},
    {"wheels", Kept::no},
    {"gnss", Kept::no},
    {"dt", Kept::yes},
    {"sweep_duration", Kept::no},
    {"clock_offset", Kept::yes},
    {"prior", Kept::no},
    {"cloud", Kept::yes},
    {"moving_probability", Kept::yes},
    {"segmenter_motion", Kept::no},
    {"static_prior", Kept::no},
    {"moving", Kept::yes},
    {"odometry", Kept::no},
    {"odometry_accepted", Kept::no},
    {"odometry_rejection", Kept::no},
    {"static_confidence", Kept::no},
    {"motion", Kept::yes},
    {"T_odom_vehicle", Kept::yes},
    {"moving_by_prediction", Kept::no},
    {"detections", Kept::yes},
    {"objects", Kept::yes},
    {"reported_before", Kept::no},
    {"is_keyframe", Kept::yes},
    {"T_map_odom", Kept::yes},
};
static_assert(std::size(fields_of_frame) == std::tuple_size_v<decltype(Frame().members())>,
              "add the new field of Frame here, and to copyOf() if it is to be kept");

/** No field has the value that it has in a new frame. */
Frame filledFrame()
{
  const Pose T = poseFromYpr(1, 2, 3, 0.1, 0.2, 0.3);
  Frame frame;
  frame.index = 7;
  frame.scan.stamp = 5;
  frame.scan.T_vehicle_lidar = T;
  frame.scan.points = {{1, 2, 3}};
  frame.T_world_vehicle_truth = T;
  frame.imu.resize(1);
  frame.wheels.resize(1);
  frame.gnss.resize(1);
  frame.dt = 0.1;
  frame.sweep_duration = 0.1;
  frame.clock_offset = 3;
  frame.prior.reliable = true;
  frame.cloud.points = {{1, 2, 3}};
  frame.cloud.intensity = {0.5F};
  frame.cloud.source = {0};
  frame.moving_probability = {0.5F};
  frame.segmenter_motion.emplace();
  frame.static_prior = {0.5F};
  frame.moving = {true};
  frame.odometry.status = MotionStatus::converged;
  frame.odometry_accepted = true;
  frame.odometry_rejection = "too fast";
  frame.static_confidence = {0.5F};
  frame.motion.status = MotionStatus::converged;
  frame.T_odom_vehicle = T;
  frame.moving_by_prediction = {true};
  frame.detections.resize(1);
  frame.objects.resize(1);
  frame.reported_before = {true};
  frame.is_keyframe = true;
  frame.T_map_odom = T;
  return frame;
}

std::vector<std::string> bytesOfFields(Frame frame)
{
  std::vector<std::string> bytes;
  const auto add = [&](auto& field)
  {
    StateArchive archive;
    archive(field);
    bytes.push_back(archive.bytes());
  };
  std::apply([&](auto&... each) { (add(each), ...); }, frame.members());
  return bytes;
}

std::vector<Kept> keptOf(FrameParts parts)
{
  const std::vector<std::string> none = bytesOfFields(Frame());
  const std::vector<std::string> all = bytesOfFields(filledFrame());
  const std::vector<std::string> copied = bytesOfFields(copyOf(filledFrame(), parts));
  std::vector<Kept> kept;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    EXPECT_NE(all[i], none[i]) << "filledFrame() lacks " << fields_of_frame[i].name;
    kept.push_back(copied[i] == all[i]    ? Kept::yes
                   : copied[i] == none[i] ? Kept::no
                                          : Kept::partly);
  }
  return kept;
}

TEST(Frame, EachFieldIsSavedAndLoaded)
{
  Frame frame = filledFrame();
  StateArchive saved;
  saved(frame);
  Frame again;
  StateArchive archive(saved.bytes());
  archive(again);
  archive.requireEnd();
  const std::vector<std::string> bytes = bytesOfFields(frame);
  const std::vector<std::string> bytes_again = bytesOfFields(again);
  for (std::size_t i = 0; i < bytes.size(); ++i)
  {
    EXPECT_EQ(bytes_again[i], bytes[i]) << fields_of_frame[i].name;
  }
}

TEST(FrameCopy, EachFieldIsKeptOrDropped)
{
  const std::vector<Kept> kept = keptOf(FrameParts::cloud);
  for (std::size_t i = 0; i < kept.size(); ++i)
  {
    EXPECT_EQ(kept[i], fields_of_frame[i].kept) << fields_of_frame[i].name;
  }
}

TEST(FrameCopy, LesserPartsHaveLessOfTheCloud)
{
  const std::vector<Kept> kept = keptOf(FrameParts::points);
  for (std::size_t i = 0; i < kept.size(); ++i)
  {
    const bool is_cloud = fields_of_frame[i].name == std::string("cloud");
    EXPECT_EQ(kept[i], is_cloud ? Kept::partly : fields_of_frame[i].kept)
        << fields_of_frame[i].name;
  }
  EXPECT_EQ(keptOf(FrameParts::intensity), kept);
  EXPECT_TRUE(copyOf(filledFrame(), FrameParts::points).cloud.intensity.empty());
  const Cloud cloud = copyOf(filledFrame(), FrameParts::intensity).cloud;
  EXPECT_EQ(cloud.points, filledFrame().cloud.points);
  EXPECT_EQ(cloud.intensity, filledFrame().cloud.intensity);
}

/** Which points are of which lidar is known by their sources. */
TEST(FrameCopy, PartsOfTheScanAreKeptWithTheSources)
{
  Frame frame = filledFrame();
  frame.scan.parts.resize(1);
  EXPECT_TRUE(copyOf(frame, FrameParts::points).scan.parts.empty());
  EXPECT_TRUE(copyOf(frame, FrameParts::intensity).scan.parts.empty());
  EXPECT_EQ(copyOf(frame, FrameParts::cloud).scan.parts.size(), 1U);
  EXPECT_EQ(copyOf(frame, FrameParts::all).scan.parts.size(), 1U);
}

TEST(FrameCopy, AllIsAllButWhatOnlyTheOdometryReads)
{
  const std::vector<Kept> kept = keptOf(FrameParts::all);
  for (std::size_t i = 0; i < kept.size(); ++i)
  {
    const std::string name = fields_of_frame[i].name;
    const bool dropped = name == "static_confidence" || name == "static_prior";
    EXPECT_EQ(kept[i], dropped ? Kept::no : Kept::yes) << name;
  }
}
}  // namespace
}  // namespace dyslam
