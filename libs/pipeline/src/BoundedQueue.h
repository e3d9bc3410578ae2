// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

namespace dyslam
{
/** Hands items from one thread to another, in order, at most `capacity` of them waiting.
 *
 * Either side may end it, with or without an error: close() ends it for the pushing side (what
 * waits is still taken), stop() for the taking side (what waits is dropped). The error is thrown
 * once, to the side that meets it first. Every function may be called from any thread.
 */
template <typename T>
class BoundedQueue
{
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity > 0 ? capacity : 1) {}

  /** Waits while the queue is full. False, and nothing is added, once the queue has ended. */
  bool push(T item)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || items_.size() < capacity_; });
    if (ended_)
    {
      throwError();
      return false;
    }
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /** Waits while the queue is empty. Nothing once it has ended and all items are taken. */
  [[nodiscard]] std::optional<T> pop()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [&] { return ended_ || !items_.empty(); });
    if (items_.empty())
    {
      throwError();
      return std::nullopt;
    }
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    changed_.notify_all();
    return item;
  }

  /** No more items will come. */
  void close() { end({}, false); }
  /** No more items will come, because of this error. */
  void fail(std::exception_ptr error) { end(std::move(error), false); }
  /** No more items will be taken, because of this error if there is one. */
  void stop(std::exception_ptr error = {}) { end(std::move(error), true); }

 private:
  void end(std::exception_ptr error, bool drop)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
    if (error)
    {
      error_ = std::move(error);
    }
    if (drop)
    {
      items_.clear();
    }
    changed_.notify_all();
  }

  void throwError()
  {
    if (error_)
    {
      std::rethrow_exception(std::exchange(error_, nullptr));
    }
  }

  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<T> items_;
  std::exception_ptr error_;
  bool ended_ = false;
};
}  // namespace dyslam
