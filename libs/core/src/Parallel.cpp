// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Parallel.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace dyslam
{
struct ThreadPool::Shared
{
  std::vector<std::thread> threads;
  std::mutex mutex;
  std::condition_variable wake;
  std::condition_variable done;
  std::uint64_t generation = 0;
  bool stopping = false;
  int busy = 0;
  std::exception_ptr failure;

  // The loop under way
  const std::function<void(std::size_t, std::size_t, std::size_t)>* body = nullptr;
  std::size_t count = 0;
  std::size_t chunk_size = 1;
  std::atomic<std::size_t> next_chunk{0};

  void work()
  {
    const std::size_t chunks = chunkCount(count, chunk_size);
    for (std::size_t chunk = next_chunk++; chunk < chunks; chunk = next_chunk++)
    {
      try
      {
        const std::size_t begin = chunk * chunk_size;
        (*body)(begin, std::min(begin + chunk_size, count), chunk);
      }
      catch (...)
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!failure)
        {
          failure = std::current_exception();
        }
      }
    }
  }

  void threadLoop()
  {
    std::uint64_t seen = 0;
    for (;;)
    {
      {
        std::unique_lock<std::mutex> lock(mutex);
        wake.wait(lock, [&] { return stopping || generation != seen; });
        if (stopping)
        {
          return;
        }
        seen = generation;
      }
      work();
      const std::lock_guard<std::mutex> lock(mutex);
      if (--busy == 0)
      {
        done.notify_one();
      }
    }
  }
};

ThreadPool::ThreadPool(int threads) : shared_(std::make_unique<Shared>())
{
  if (threads <= 0)
  {
    threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  }
  for (int i = 1; i < threads; ++i)
  {
    shared_->threads.emplace_back([s = shared_.get()] { s->threadLoop(); });
  }
}

ThreadPool::~ThreadPool()
{
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->stopping = true;
  }
  shared_->wake.notify_all();
  for (auto& thread : shared_->threads)
  {
    thread.join();
  }
}

int ThreadPool::size() const
{
  return static_cast<int>(shared_->threads.size()) + 1;
}

void ThreadPool::forChunks(std::size_t count,
                           std::size_t chunk_size,
                           const std::function<void(std::size_t, std::size_t, std::size_t)>& body)
{
  auto& s = *shared_;
  chunk_size = std::max<std::size_t>(1, chunk_size);
  if (s.threads.empty() || count <= chunk_size)
  {
    for (std::size_t begin = 0, chunk = 0; begin < count; begin += chunk_size, ++chunk)
    {
      body(begin, std::min(begin + chunk_size, count), chunk);
    }
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(s.mutex);
    s.body = &body;
    s.count = count;
    s.chunk_size = chunk_size;
    s.next_chunk = 0;
    s.failure = nullptr;
    s.busy = static_cast<int>(s.threads.size());
    ++s.generation;
  }
  s.wake.notify_all();
  s.work();
  std::unique_lock<std::mutex> lock(s.mutex);
  s.done.wait(lock, [&] { return s.busy == 0; });
  s.body = nullptr;
  if (s.failure)
  {
    std::rethrow_exception(s.failure);
  }
}
}  // namespace dyslam
