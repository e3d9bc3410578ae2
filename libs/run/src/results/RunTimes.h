// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/BoundedQueue.h>
#include <mrpt/system/CTimeLogger.h>

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

namespace dyslam
{
/** Times of a run: since its begin, of its stages, and for which its threads waited. */
class RunTimes
{
 public:
  /** The run begins now. */
  RunTimes();

  /** Moves the begin back by the time of an earlier part of the run [s]. */
  void beginEarlier(double seconds);
  /** Leaves out scans that were processed before the run was resumed: the times of their stages are
   * unknown. */
  void leaveOut(std::size_t scans) { left_out_ = scans; }
  /** Adds a waiting time of one of the caller's threads [s]. */
  void noteWait(const std::string& thread, double seconds) { waits_[thread] += seconds; }

  [[nodiscard]] std::chrono::steady_clock::time_point begin() const { return begin_; }
  /** Time since the begin [s]. */
  [[nodiscard]] double seconds() const;
  /** Gets the time of each stage. */
  [[nodiscard]] mrpt::system::CTimeLogger& stages() { return stages_; }

  /** Mean time of each stage [ms]. \param scans number of scans of the run */
  [[nodiscard]] std::map<std::string, double> stageMilliseconds(std::size_t scans) const;
  /** Mean waiting time of each thread [ms]. \param scans number of scans of the run
   * \param writing waiting times of the writing thread and of the back end for it */
  [[nodiscard]] std::map<std::string, double> waitMilliseconds(std::size_t scans,
                                                               const QueueWaits& writing) const;

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  mrpt::system::CTimeLogger stages_;
  std::size_t left_out_ = 0;
  std::map<std::string, double> waits_;  //!< waiting times of the caller's threads [s]
};
}  // namespace dyslam
