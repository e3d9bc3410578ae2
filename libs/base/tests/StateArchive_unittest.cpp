// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "SavedState.h"

namespace dyslam
{
namespace
{
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
  EXPECT_EQ(fields::count<Everything>(), 5U);
}

TEST(StateArchive, BytesThatEndEarlyAreAnError)
{
  Everything all = everything();
  const std::string bytes = saved(all);
  for (std::size_t size = 0; size < bytes.size(); ++size)
  {
    const std::string part = bytes.substr(0, size);
    EXPECT_THROW((void)loaded<Everything>(part), UserError) << size;
  }
  EXPECT_THROW((void)loaded<Everything>(bytes + "x"), UserError);
}

TEST(StateArchive, CountsBeyondTheBytesTakeNoMemory)
{
  const std::uint64_t many = std::uint64_t{1} << 60U;
  std::string bytes(sizeof many, '\0');
  std::memcpy(bytes.data(), &many, sizeof many);
  EXPECT_THROW((void)loaded<std::vector<double>>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::string>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::vector<bool>>(bytes), UserError);
  EXPECT_THROW((void)loaded<std::deque<Everything>>(bytes), UserError);
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
