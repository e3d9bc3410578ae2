// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/BoundedQueue.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>

namespace dyslam
{
namespace
{
std::exception_ptr anError()
{
  return std::make_exception_ptr(std::runtime_error("cut"));
}

/** Runs `action` in a thread and says whether it waited until `release` was called. */
template <typename Action, typename Release>
bool waits(Action action, Release release)
{
  std::atomic<bool> started = false;
  std::atomic<bool> done = false;
  std::thread thread(
      [&]
      {
        started = true;
        action();
        done = true;
      });
  while (!started)
  {
    std::this_thread::yield();
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const bool waited = !done;
  release();
  thread.join();
  return waited;
}

TEST(BoundedQueue, SaysWhichSideWaited)
{
  BoundedQueue<int> queue(1);
  EXPECT_TRUE(waits([&] { (void)queue.pop(); }, [&] { queue.push(1); }));
  EXPECT_GT(queue.waits().for_items, 0.03);
  EXPECT_EQ(queue.waits().for_room, 0);
  queue.push(1);
  EXPECT_TRUE(waits([&] { queue.push(2); }, [&] { (void)queue.pop(); }));
  EXPECT_GT(queue.waits().for_room, 0.03);
}

TEST(BoundedQueue, ShowsTheItemThatComesNext)
{
  BoundedQueue<int> queue(2);
  const int* seen = nullptr;
  EXPECT_TRUE(waits([&] { seen = queue.peek(); }, [&] { queue.push(7); }));
  ASSERT_NE(seen, nullptr);
  queue.push(8);
  EXPECT_EQ(*seen, 7) << "it stays where it is";
  EXPECT_EQ(queue.pop(), 7);
  EXPECT_EQ(*queue.peek(), 8);
  queue.fail(anError());
  EXPECT_EQ(*queue.peek(), 8);
  EXPECT_EQ(queue.pop(), 8);
  EXPECT_EQ(queue.peek(), nullptr) << "the error is left to pop()";
  EXPECT_THROW((void)queue.pop(), std::runtime_error);
}

TEST(BoundedQueue, KeepsTheOrderOfManyItems)
{
  BoundedQueue<int> queue(3);
  std::thread producer(
      [&]
      {
        for (int i = 0; i < 10000; ++i)
        {
          ASSERT_TRUE(queue.push(i));
        }
        queue.close();
      });
  int next = 0;
  while (const auto item = queue.pop())
  {
    ASSERT_EQ(*item, next++);
  }
  producer.join();
  EXPECT_EQ(next, 10000);
}

TEST(BoundedQueue, WaitsWhileFullAndWhileEmpty)
{
  BoundedQueue<int> queue(2);
  EXPECT_TRUE(waits([&] { EXPECT_EQ(queue.pop(), 1); }, [&] { queue.push(1); }));
  queue.push(2);
  queue.push(3);
  EXPECT_TRUE(waits([&] { EXPECT_TRUE(queue.push(4)); }, [&] { EXPECT_EQ(queue.pop(), 2); }));
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 4);
}

TEST(BoundedQueue, ClosedItGivesWhatWaitsAndTakesNoMore)
{
  BoundedQueue<std::unique_ptr<int>> queue(2);
  queue.push(std::make_unique<int>(7));
  queue.close();
  EXPECT_FALSE(queue.push(std::make_unique<int>(8)));
  EXPECT_EQ(*queue.pop().value(), 7);
  EXPECT_FALSE(queue.pop());
}

TEST(BoundedQueue, ThrowsAnErrorOfThePushingSideOnceAndAfterTheItems)
{
  BoundedQueue<int> queue(2);
  queue.push(1);
  queue.fail(anError());
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_THROW((void)queue.pop(), std::runtime_error);
  EXPECT_FALSE(queue.pop());
}

TEST(BoundedQueue, ThrowsAnErrorOfTheTakingSideOnceAndDropsTheItems)
{
  BoundedQueue<int> queue(1);
  queue.push(1);
  EXPECT_TRUE(waits([&] { EXPECT_THROW(queue.push(2), std::runtime_error); },
                    [&] { queue.stop(anError()); }));
  EXPECT_FALSE(queue.push(3));
  EXPECT_FALSE(queue.pop());
}

TEST(BoundedQueue, StopAndCloseWakeWhoeverWaits)
{
  BoundedQueue<int> full(1);
  full.push(1);
  EXPECT_TRUE(waits([&] { EXPECT_FALSE(full.push(2)); }, [&] { full.stop(); }));
  BoundedQueue<int> empty(1);
  EXPECT_TRUE(waits([&] { EXPECT_FALSE(empty.pop()); }, [&] { empty.close(); }));
}
}  // namespace
}  // namespace dyslam
