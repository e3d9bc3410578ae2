// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Parallel.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace dyslam
{
namespace
{
double chunkedSum(ThreadPool& pool, std::size_t count)
{
  constexpr std::size_t chunk_size = 100;
  std::vector<double> partial(ThreadPool::chunkCount(count, chunk_size), 0.0);
  pool.forChunks(count, chunk_size,
                 [&](std::size_t begin, std::size_t end, std::size_t chunk)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     partial[chunk] += std::sin(static_cast<double>(i)) * 1e-3;
                   }
                 });
  return std::accumulate(partial.begin(), partial.end(), 0.0);
}

TEST(ThreadPool, SameBytesForAnyThreadCount)
{
  ThreadPool one(1);
  const double expected = chunkedSum(one, 12345);
  for (const int threads : {2, 3, 7})
  {
    ThreadPool pool(threads);
    for (int repeat = 0; repeat < 200; ++repeat)
    {
      ASSERT_EQ(chunkedSum(pool, 12345), expected);
    }
  }
}

TEST(ThreadPool, EmptyLoopCallsNothing)
{
  ThreadPool pool(2);
  pool.forChunks(0, 10, [](std::size_t, std::size_t, std::size_t) { FAIL(); });
}

TEST(ThreadPool, ExceptionsReachTheCallerAndThePoolStaysUsable)
{
  ThreadPool pool(2);
  EXPECT_THROW(pool.forChunks(100, 1,
                              [](std::size_t i, std::size_t, std::size_t)
                              {
                                if (i == 42)
                                {
                                  throw std::runtime_error("x");
                                }
                              }),
               std::runtime_error);
  EXPECT_GT(std::abs(chunkedSum(pool, 1000)), 0);
}
}  // namespace
}  // namespace dyslam
