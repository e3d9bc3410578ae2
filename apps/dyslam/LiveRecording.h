// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/LiveRecorder.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace dyslam
{
/** Records a live input in a thread of its own (recordLive()), while a run reads the
 * rawlog, and measures how far the run is behind. */
class LiveRecording
{
 public:
  /** Begins, and returns once the first scan is in the rawlog.
   * \param stop true: the recording ends; asked from several threads \param print receives lines
   * for the user, from several threads \param vehicle_frame see LiveRecorderHooks; called before
   * this returns \throws UserError if there is no first scan. */
  LiveRecording(const std::string& input,
                const std::string& rawlog,
                const ScanConverterOptions& options,
                const std::function<bool()>& stop,
                const std::function<void(const std::string&)>& print,
                const std::function<void(const std::string&)>& vehicle_frame);
  /** Ends the recording. */
  ~LiveRecording();
  LiveRecording(const LiveRecording&) = delete;
  LiveRecording& operator=(const LiveRecording&) = delete;

  /** Ends the recording, and waits until the rawlog is complete. */
  void end();
  /** Whether packets are still recorded. */
  [[nodiscard]] bool goesOn() const;
  /** What was recorded. \pre end() */
  [[nodiscard]] const ConversionResult& result() const { return result_; }
  /** Error that ended it; nothing if it was ended on request. \pre end() */
  [[nodiscard]] const std::optional<std::string>& failure() const { return failure_; }

  /** The run has processed a scan. \param index its number in the rawlog */
  void noteProcessed(std::size_t index);
  /** Time from the moment when a scan was recorded until the run had processed it: of the latest
   * one, or of the latest one when the recording ended [s]. */
  [[nodiscard]] double lag() const;

 private:
  using Clock = std::chrono::steady_clock;

  void record(const std::string& input,
              const std::string& rawlog,
              const ScanConverterOptions& options,
              const LiveRecorderHooks& hooks);

  std::atomic<bool> is_ending_ = false;
  mutable std::mutex mutex_;  //!< of all up to failure_
  std::condition_variable changed_;
  std::vector<Clock::time_point> recorded_;  //!< time of each scan
  double lag_ = 0;                           //!< [s]
  bool is_any_processed_ = false;
  bool has_ended_ = false;
  ConversionResult result_;
  std::optional<std::string> failure_;
  std::thread thread_;
};
}  // namespace dyslam
