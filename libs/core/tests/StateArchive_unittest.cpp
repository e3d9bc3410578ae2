// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/StateArchive.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <tuple>

namespace dyslam
{
namespace
{
template <typename T>
std::string saved(T& value)
{
  StateArchive archive;
  archive(value);
  return archive.bytes();
}

template <typename T>
T loaded(const std::string& bytes)
{
  T value;
  StateArchive archive(bytes);
  archive(value);
  archive.requireEnd();
  return value;
}

Frame someFrame()
{
  Frame frame;
  frame.index = 7;
  frame.scan.points = {{1, 2, 3}, {NAN, 5, 6}};
  frame.scan.ring = {3, 9};
  frame.scan.sensor_label = "lidar";
  frame.T_world_vehicle_truth = poseFromYpr(1, 2, 3, 0.1, 0.2, 0.3);
  frame.moving = {true, false, true};
  frame.moving_by_prediction = {false, false, true};
  frame.objects.resize(2);
  frame.objects[1].object_class = ObjectClass::truck;
  frame.objects[1].reported = true;
  frame.T_map_odom = poseFromYpr(3, 2, 1, 0.3, 0.2, 0.1);
  return frame;
}

class Counter
{
 public:
  void exchangeState(StateArchive& archive) { archive(count_); }
  int count_ = 0;
};

struct Everything
{
  std::map<int, std::vector<std::string>> map;
  std::set<std::pair<int, double>> set;
  std::deque<std::optional<double>> deque;
  std::array<std::vector<int>, 2> array;
  Counter own;
};

Everything everything()
{
  Everything all;
  all.map = {{3, {"a", ""}}, {-1, {}}};
  all.set = {{1, 0.5}};
  all.deque = {1.5, std::nullopt};
  all.array = {std::vector<int>{1}, std::vector<int>{}};
  all.own.count_ = 5;
  return all;
}

TEST(StateArchive, FrameComesBackWithAllItsFields)
{
  Frame frame = someFrame();
  const std::string bytes = saved(frame);
  Frame again = loaded<Frame>(bytes);
  EXPECT_EQ(saved(again), bytes);
  EXPECT_EQ(again.scan.points[1].y(), 5);
  EXPECT_TRUE(std::isnan(again.scan.points[1].x()));
  EXPECT_EQ(again.T_world_vehicle_truth->matrix(), frame.T_world_vehicle_truth->matrix());
  EXPECT_EQ(again.objects[1].object_class, ObjectClass::truck);
  EXPECT_EQ(again.moving, frame.moving);
  EXPECT_EQ(again.moving_by_prediction, frame.moving_by_prediction);
  EXPECT_EQ(again.T_map_odom.matrix(), frame.T_map_odom.matrix());
}

TEST(StateArchive, ContainersComeBack)
{
  Everything all = everything();
  const Everything again = loaded<Everything>(saved(all));
  EXPECT_EQ(again.map, all.map);
  EXPECT_EQ(again.set, all.set);
  EXPECT_EQ(again.deque, all.deque);
  EXPECT_EQ(again.array, all.array);
  EXPECT_EQ(again.own.count_, 5);
}

TEST(StateArchive, LoadingReplacesWhatWasThere)
{
  Everything empty;
  const std::string bytes = saved(empty);
  Everything all = everything();
  StateArchive archive(bytes);
  archive(all);
  EXPECT_TRUE(all.map.empty() && all.set.empty() && all.deque.empty());
}

TEST(StateArchive, FieldsAreCounted)
{
  EXPECT_EQ(fields::count<Box>(), 3U);
  EXPECT_EQ(fields::count<MotionEstimate>(), 10U);
  EXPECT_EQ(fields::count<Frame>(), std::tuple_size_v<decltype(Frame().members())>);
}

TEST(StateArchive, BytesThatEndEarlyAreAnError)
{
  Frame frame = someFrame();
  const std::string bytes = saved(frame);
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    const std::string part = bytes.substr(0, size);
    EXPECT_THROW((void)loaded<Frame>(part), UserError) << size;
  }
  EXPECT_THROW((void)loaded<Frame>(bytes + "x"), UserError);
}

TEST(StateArchive, CountsBeyondTheBytesTakeNoMemory)
{
  const std::uint64_t many = std::uint64_t{1} << 60U;
  std::string bytes(sizeof many, '\0');
  std::memcpy(bytes.data(), &many, sizeof many);
  EXPECT_THROW((void)loaded<std::vector<double>>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::string>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::vector<bool>>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::deque<Frame>>(bytes), UserError);
  EXPECT_THROW((void)(loaded<std::map<int, int>>(bytes)), UserError);
}

TEST(StateArchive, AFlagIsZeroOrOne)
{
  const std::string byte(1, '\x02');
  StateArchive wrong(byte);
  bool flag = false;
  EXPECT_THROW(wrong(flag), UserError);
}
}  // namespace
}  // namespace dyslam
