// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/pipeline/ReadAhead.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace dyslam
{
struct ReadAhead::Shared
{
  std::function<std::optional<Frame>()> read;
  std::size_t depth;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Frame> frames;
  std::exception_ptr failure;
  bool ended = false;
  bool stopping = false;
  std::thread thread;

  void loop()
  {
    for (;;)
    {
      {
        std::unique_lock<std::mutex> lock(mutex);
        changed.wait(lock, [&] { return stopping || frames.size() < depth; });
        if (stopping)
        {
          return;
        }
      }
      std::optional<Frame> frame;
      std::exception_ptr thrown;
      try
      {
        frame = read();
      }
      catch (...)
      {
        thrown = std::current_exception();
      }
      const std::lock_guard<std::mutex> lock(mutex);
      if (frame)
      {
        frames.push_back(std::move(*frame));
      }
      else
      {
        failure = thrown;
        ended = true;
      }
      changed.notify_all();
      if (ended)
      {
        return;
      }
    }
  }
};

ReadAhead::ReadAhead(std::function<std::optional<Frame>()> next, std::size_t depth)
    : shared_(std::make_unique<Shared>())
{
  shared_->read = std::move(next);
  shared_->depth = depth;
  shared_->thread = std::thread([s = shared_.get()] { s->loop(); });
}

ReadAhead::~ReadAhead()
{
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->stopping = true;
  }
  shared_->changed.notify_all();
  shared_->thread.join();
}

std::optional<Frame> ReadAhead::next()
{
  auto& s = *shared_;
  std::unique_lock<std::mutex> lock(s.mutex);
  s.changed.wait(lock, [&] { return s.ended || !s.frames.empty(); });
  if (s.frames.empty())
  {
    if (s.failure)
    {
      std::rethrow_exception(std::exchange(s.failure, nullptr));
    }
    return std::nullopt;
  }
  std::optional<Frame> frame(std::move(s.frames.front()));
  s.frames.pop_front();
  s.changed.notify_all();
  return frame;
}
}  // namespace dyslam
