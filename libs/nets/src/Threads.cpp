// SPDX-License-Identifier: BSD-3-Clause
#include <ATen/Parallel.h>
#include <dyslam/nets/Threads.h>

#include <algorithm>

namespace dyslam
{
namespace
{
thread_local ThreadPool* pool_of_loops = nullptr;
}  // namespace

void useTorchThreads(int threads)
{
  const int wanted = std::max(1, threads);
  // Setting the number of threads may restart the thread pool.
  if (at::get_num_threads() != wanted)
  {
    at::set_num_threads(wanted);
  }
}

LoopsOnPool::LoopsOnPool(ThreadPool& pool) : before_(pool_of_loops)
{
  pool_of_loops = &pool;
  useTorchThreads(1);
}

LoopsOnPool::~LoopsOnPool()
{
  pool_of_loops = before_;
}

void forRows(std::int64_t count,
             std::int64_t grain,
             const std::function<void(std::int64_t, std::int64_t)>& body)
{
#ifndef INTRA_OP_PARALLEL
#error "at::parallel_for is a plain loop here: compile with OpenMP"
#endif
  if (pool_of_loops != nullptr)
  {
    pool_of_loops->forChunks(
        static_cast<std::size_t>(count), static_cast<std::size_t>(grain),
        [&](std::size_t begin, std::size_t end, std::size_t)
        { body(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)); });
    return;
  }
  at::parallel_for(0, count, grain, body);
}

void forBlocks(std::int64_t count,
               std::int64_t block,
               const std::function<void(std::int64_t, std::int64_t)>& body)
{
  forRows((count + block - 1) / block, 1,
          [&](std::int64_t begin, std::int64_t end)
          {
            for (std::int64_t first = begin * block; first < std::min(count, end * block);
                 first += block)
            {
              body(first, std::min(block, count - first));
            }
          });
}

void inParallel(const std::function<void()>& one, const std::function<void()>& other)
{
  forEachRow(2, 1, [&](std::size_t i) { (i == 0 ? one : other)(); });
}
}  // namespace dyslam
