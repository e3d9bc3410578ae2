// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

namespace dyslam
{
/** Waiting times of the two sides of a queue [s]. */
struct QueueWaits
{
  double for_room = 0;   //!< time that the pushing side waited, with a full queue [s]
  double for_items = 0;  //!< time that the taking side waited, with an empty queue [s]
};

/** Queue of items from one thread to another, of at most `capacity` items.
 *
 * Either side may end it, with or without an error: close() ends it for the pushing side (waiting
 * items are still taken), stop() for the taking side (waiting items are dropped). The error is
 * thrown once, to the side that meets it first. Every function may be called from any thread.
 */
template <typename T>
class BoundedQueue
{
 public:
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity > 0 ? capacity : 1) {}

  /** Adds an item; waits while the queue is full. \return false, without adding, if it has ended */
  bool push(T item)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    wait(lock, waits_.for_room, [&] { return ended_ || items_.size() < capacity_; });
    if (ended_)
    {
      throwError();
      return false;
    }
    items_.push_back(std::move(item));
    changed_.notify_all();
    return true;
  }

  /** Takes an item; waits while the queue is empty. Nothing if it has ended and all are taken. */
  [[nodiscard]] std::optional<T> pop()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    wait(lock, waits_.for_items, [&] { return ended_ || !items_.empty(); });
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

  /** The item that pop() will return, after waiting for it; null if the queue has ended and all
   * items are taken. Valid until the next pop() or the end; for a single taking thread. Does not
   * throw: pop() reports the error. */
  [[nodiscard]] const T* peek()
  {
    std::unique_lock<std::mutex> lock(mutex_);
    wait(lock, waits_.for_items, [&] { return ended_ || !items_.empty(); });
    return items_.empty() ? nullptr : &items_.front();
  }

  /** Ends the queue for the pushing side: no more items will be added. */
  void close() { end({}, false); }
  /** Ends the queue for the pushing side because of an error. */
  void fail(std::exception_ptr error) { end(std::move(error), false); }
  /** Ends the queue for the taking side: no more items will be taken. */
  void stop(std::exception_ptr error = {}) { end(std::move(error), true); }

  [[nodiscard]] QueueWaits waits()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    return waits_;
  }

 private:
  template <typename Ready>
  void wait(std::unique_lock<std::mutex>& lock, double& waited, const Ready& ready)
  {
    if (!ready())
    {
      const auto begin = std::chrono::steady_clock::now();
      changed_.wait(lock, ready);
      waited += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
  }

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
  QueueWaits waits_;
};
}  // namespace dyslam
