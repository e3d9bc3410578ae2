// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Parallel.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <exception>
#include <mutex>
#include <vector>
#endif

namespace dyslam
{
struct ThreadPool::Shared
{
  // More threads than cores gain nothing, and TBB warns of them on stderr.
  explicit Shared(int threads)
      : size(threads), arena(std::min(threads, tbb::info::default_concurrency()))
  {
  }

  template <typename Body>
  void run(std::size_t chunks, const Body& body)
  {
#ifdef __SANITIZE_THREAD__
    // The packaged TBB is not instrumented: with it, the sanitizer would report false races.
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::exception_ptr failure;
    const auto work = [&]
    {
      try
      {
        for (std::size_t chunk = next++; chunk < chunks; chunk = next++)
        {
          body(chunk);
        }
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(mutex);
        failure = std::current_exception();
      }
    };
    std::vector<std::thread> threads;
    for (int i = 1; i < size; ++i)
    {
      threads.emplace_back(work);
    }
    work();
    for (std::thread& thread : threads)
    {
      thread.join();
    }
    if (failure)
    {
      std::rethrow_exception(failure);
    }
#else
    arena.execute([&]
                  { tbb::parallel_for(std::size_t{0}, chunks, body, tbb::simple_partitioner()); });
#endif
  }

  int size;
  tbb::task_arena arena;
};

ThreadPool::ThreadPool(int threads)
    : shared_(std::make_unique<Shared>(
          threads > 0 ? threads
                      : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()))))
{
}

ThreadPool::~ThreadPool() = default;

int ThreadPool::size() const
{
  return shared_->size;
}

void ThreadPool::forChunks(std::size_t count,
                           std::size_t chunk_size,
                           const std::function<void(std::size_t, std::size_t, std::size_t)>& body)
{
  chunk_size = std::max<std::size_t>(1, chunk_size);
  const std::size_t chunks = chunkCount(count, chunk_size);
  const auto run = [&](std::size_t chunk)
  {
    const std::size_t begin = chunk * chunk_size;
    body(begin, std::min(begin + chunk_size, count), chunk);
  };
  if (shared_->size > 1 && chunks > 1)
  {
    shared_->run(chunks, run);
    return;
  }
  for (std::size_t chunk = 0; chunk < chunks; ++chunk)
  {
    run(chunk);
  }
}
}  // namespace dyslam
