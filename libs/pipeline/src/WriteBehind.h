// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <thread>

#include "BoundedQueue.h"

namespace dyslam
{
/** Runs jobs one after the other in a thread of its own, so that compressing and writing do not
 * hold up the estimation. Jobs run in the order they were given. */
class WriteBehind
{
 public:
  /** \param depth jobs that may wait; add() blocks beyond. */
  explicit WriteBehind(std::size_t depth = 4);
  /** Waits for every job. */
  ~WriteBehind();
  WriteBehind(const WriteBehind&) = delete;
  WriteBehind& operator=(const WriteBehind&) = delete;

  /** Throws what an earlier job threw, once; jobs after a failed one and after finish() are
   * dropped. */
  void add(std::function<void()> job) { jobs_.push(std::move(job)); }
  /** Waits for every job. Throws what a job threw, unless add() did. */
  void finish();

  [[nodiscard]] QueueWaits waits() { return jobs_.waits(); }

 private:
  BoundedQueue<std::function<void()>> jobs_;
  std::thread thread_;
};
}  // namespace dyslam
