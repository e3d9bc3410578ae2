// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/BoundedQueue.h>

#include <functional>
#include <thread>

namespace dyslam
{
/** Runs jobs in another thread, one after the other in the order of add(): for compressing and
 * writing, so that the estimation does not wait for them. */
class JobThread
{
 public:
  /** \param depth number of jobs that may wait before add() blocks */
  explicit JobThread(std::size_t depth = 4);
  /** Waits for every job. */
  ~JobThread();
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  /** Adds a job. Throws the exception of an earlier job, once; jobs after a failed one and after
   * finish() are dropped. */
  void add(std::function<void()> job) { jobs_.push(std::move(job)); }
  /** Waits for every job. Throws the exception of a job, unless add() did. */
  void finish();

  [[nodiscard]] QueueWaits waits() { return jobs_.waits(); }

 private:
  BoundedQueue<std::function<void()>> jobs_;
  std::thread thread_;
};
}  // namespace dyslam
