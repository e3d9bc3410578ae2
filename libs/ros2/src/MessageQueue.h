// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/ros2/Ros2Domain.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <utility>

namespace dyslam
{
/** Messages on their way from the threads that receive them to the one that takes them. */
class MessageQueue
{
 public:
  void put(Ros2Message message)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (bytes_ + message.data.size() > most_bytes)
    {
      ++lost_[message.topic];
      return;
    }
    bytes_ += message.data.size();
    messages_.push_back(std::move(message));
    changed_.notify_all();
  }
  /** \return false if none came in this time, or wake() was called */
  [[nodiscard]] bool take(Ros2Message& message, std::chrono::milliseconds wait)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, wait, [this] { return !messages_.empty() || is_woken_; });
    is_woken_ = false;
    if (messages_.empty())
    {
      return false;
    }
    message = std::move(messages_.front());
    messages_.pop_front();
    bytes_ -= message.data.size();
    return true;
  }
  /** Ends a take() that waits. */
  void wake()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_woken_ = true;
    changed_.notify_all();
  }
  void noteLost(const std::string& topic, std::size_t messages)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    lost_[topic] += messages;
  }
  [[nodiscard]] std::size_t lost(const std::string& topic) const
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = lost_.find(topic);
    return found == lost_.end() ? 0 : found->second;
  }

 private:
  static constexpr std::size_t most_bytes = std::size_t{1} << 30U;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Ros2Message> messages_;
  std::size_t bytes_ = 0;
  bool is_woken_ = false;
  std::map<std::string, std::size_t> lost_;  //!< number of messages, by topic
};
}  // namespace dyslam
