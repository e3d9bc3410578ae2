// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/JobThread.h>
#include <dyslam/pipeline/ReadAhead.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace dyslam
{
namespace
{
TEST(ReadAhead, KeepsTheOrderAndEnds)
{
  std::size_t given = 0;
  ReadAhead reader(
      [&]() -> std::optional<Frame>
      {
        if (given == 50)
        {
          return std::nullopt;
        }
        Frame frame;
        frame.index = given++;
        return frame;
      });
  for (std::size_t i = 0; i < 50; ++i)
  {
    const auto frame = reader.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
  }
  EXPECT_FALSE(reader.next());
  EXPECT_FALSE(reader.next());
}

TEST(ReadAhead, DeliversFramesBeforeTheError)
{
  int given = 0;
  ReadAhead reader(
      [&]() -> std::optional<Frame>
      {
        if (++given > 3)
        {
          throw std::runtime_error("cut");
        }
        return Frame();
      });
  for (int i = 0; i < 3; ++i)
  {
    EXPECT_TRUE(reader.next());
  }
  EXPECT_THROW((void)reader.next(), std::runtime_error);
  EXPECT_FALSE(reader.next());
}

TEST(ReadAhead, StagesInARowKeepOrderAndErrors)
{
  std::size_t given = 0;
  ReadAhead first(
      [&]() -> std::optional<Frame>
      {
        if (given == 40)
        {
          throw std::runtime_error("cut");
        }
        Frame frame;
        frame.index = given++;
        return frame;
      });
  ReadAhead second(
      [&]
      {
        auto frame = first.next();
        if (frame)
        {
          frame->dt = 2.0 * static_cast<double>(frame->index);
        }
        return frame;
      });
  for (std::size_t i = 0; i < 40; ++i)
  {
    const auto frame = second.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->index, i);
    EXPECT_EQ(frame->dt, 2.0 * static_cast<double>(i));
  }
  EXPECT_THROW((void)second.next(), std::runtime_error);
  EXPECT_FALSE(second.next());
}

TEST(ReadAhead, StagesInARowMayBeDroppedHalfway)
{
  ReadAhead first([] { return std::optional<Frame>(Frame()); });
  ReadAhead second([&] { return first.next(); });
  EXPECT_TRUE(second.next());
}

TEST(ReadAhead, MayBeDroppedHalfway)
{
  ReadAhead reader([] { return std::optional<Frame>(Frame()); });
  EXPECT_TRUE(reader.next());
}

TEST(JobThread, RunsJobsInOrder)
{
  std::vector<int> done;
  JobThread writer(2);
  for (int i = 0; i < 20; ++i)
  {
    writer.add([&done, i] { done.push_back(i); });
  }
  writer.finish();
  ASSERT_EQ(done.size(), 20U);
  EXPECT_EQ(done.front(), 0);
  EXPECT_EQ(done.back(), 19);
}

TEST(JobThread, TellsOfAFailureAndDropsTheRest)
{
  bool later = false;
  JobThread writer;
  writer.add([] { throw std::runtime_error("disk full"); });
  EXPECT_THROW({ writer.finish(); }, std::runtime_error);
  writer.add([&] { later = true; });
  writer.finish();
  EXPECT_FALSE(later);
}
}  // namespace
}  // namespace dyslam
