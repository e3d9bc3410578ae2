// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <thread>

#include "BoundedQueue.h"

namespace dyslam
{
/** Runs jobs one after the other in a thread of its own, in the order they were given, such as
 * compressing and writing, which do not hold up the estimation then. */
class JobThread
{
 public:
  /** \param depth jobs that may wait; add() blocks beyond. */
  explicit JobThread(std::size_t depth = 4);
  /** Waits for every job. */
  ~JobThread();
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

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
