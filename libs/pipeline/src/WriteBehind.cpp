// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/WriteBehind.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace dyslam
{
struct WriteBehind::Shared
{
  std::size_t depth;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> jobs;
  std::exception_ptr failure;
  bool working = false;
  bool failed = false;
  bool stopping = false;
  std::thread thread;

  void loop()
  {
    std::unique_lock<std::mutex> lock(mutex);
    for (;;)
    {
      changed.wait(lock, [&] { return stopping || !jobs.empty(); });
      if (jobs.empty())
      {
        return;
      }
      const auto job = std::move(jobs.front());
      jobs.pop_front();
      if (failed)
      {
        changed.notify_all();
        continue;
      }
      working = true;
      lock.unlock();
      std::exception_ptr thrown;
      try
      {
        job();
      }
      catch (...)
      {
        thrown = std::current_exception();
      }
      lock.lock();
      working = false;
      if (thrown)
      {
        failure = thrown;
        failed = true;
      }
      changed.notify_all();
    }
  }

  void rethrow()
  {
    if (failure)
    {
      std::rethrow_exception(std::exchange(failure, nullptr));
    }
  }
};

WriteBehind::WriteBehind(std::size_t depth) : shared_(std::make_unique<Shared>())
{
  shared_->depth = depth;
  shared_->thread = std::thread([s = shared_.get()] { s->loop(); });
}

WriteBehind::~WriteBehind()
{
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->stopping = true;
  }
  shared_->changed.notify_all();
  shared_->thread.join();
}

void WriteBehind::add(std::function<void()> job)
{
  auto& s = *shared_;
  std::unique_lock<std::mutex> lock(s.mutex);
  s.changed.wait(lock, [&] { return s.failed || s.jobs.size() < s.depth; });
  s.rethrow();
  s.jobs.push_back(std::move(job));
  s.changed.notify_all();
}

void WriteBehind::finish()
{
  auto& s = *shared_;
  std::unique_lock<std::mutex> lock(s.mutex);
  s.changed.wait(lock, [&] { return s.jobs.empty() && !s.working; });
  s.rethrow();
}
}  // namespace dyslam
