// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/run/SlamRun.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "../folder/OutputFolder.h"
#include "StateFile.h"

namespace dyslam
{
/** Identity and progress of the run that a state belongs to. */
struct SavedRun
{
  std::string version;  //!< version of the program
  std::string rawlog;   //!< absolute path
  std::uint64_t rawlog_size = 0;
  std::string settings;  //!< all of them, as an ini
  /** Second of two passes: `dyseg.labels` is keptLabelsOf() the output folder, also if that has
   * been moved. */
  bool is_second_pass = false;
  std::vector<std::string> inputs;
  std::string sensor;
  std::vector<std::string> warnings;
  bool static_scans = false;
  bool labels = false;
  bool probabilities = false;
  std::size_t scans = 0;             //!< number of processed scans
  std::uint32_t scans_checksum = 0;  //!< ScanSum of the processed scans
  double seconds = 0;                //!< time of the run so far [s]
  double first_pass_time = 0;        //!< part of `seconds` for the first of two passes [s]
};

class ScanSum;

/** Identity and progress of a run.
 * \param config all settings \param scans checksum of the processed scans
 * \param seconds time of the run so far [s] */
[[nodiscard]] SavedRun savedRunOf(const SlamRunSettings& settings,
                                  const Config& config,
                                  const ScanSum& scans,
                                  double seconds);

/** Settings of the saved run, with those that are given again.
 * \throws UserError if outputs are given that the run did not have. */
[[nodiscard]] SlamRunSettings settingsOf(const SavedRun& saved, const SlamRunSettings& given);

/** \throws UserError if a setting differs from that of the saved run.
 * \param config all settings of the run that resumes it */
void requireSameSettings(const SavedRun& saved, const Config& config);

/** Parts of the state of a run, which different threads write. */
enum class StatePart
{
  run,  //!< SavedRun
  front_end,
  back_end,      //!< back end and statistics
  outputs,       //!< outputs in the thread of the back end
  slow_outputs,  //!< outputs in the writing thread
};
constexpr std::size_t state_parts = 5;

/** Locked folder with the state of a run that can be resumed. */
struct RunToResume
{
  /** Of a second pass, the settings have the labels in this folder.
   * \throws UserError if there is no state, it cannot be used, or another run writes there. */
  explicit RunToResume(const std::string& folder);

  /** Loads a part. */
  template <typename Load>
  void load(StatePart part, const Load& load)
  {
    StateArchive archive = file.part(static_cast<std::size_t>(part));
    load(archive);
    archive.requireEnd();
  }

  std::unique_ptr<OutputFolder> lock;
  StateFileReader file;
  SavedRun run;
};

/** Running checksum of the scans of a recording. */
class ScanSum
{
 public:
  void add(const Frame& frame);
  [[nodiscard]] std::size_t scans() const { return scans_; }
  [[nodiscard]] std::uint32_t sum() const { return sum_; }

 private:
  std::size_t scans_ = 0;
  std::uint32_t sum_ = 0;
};

/** What the front end's thread adds to a checkpoint, after the frame behind which it is made. */
struct BegunCheckpoint
{
  std::string front_end;  //!< Pipeline::exchangeFrontEndState()
  std::string method;     //!< Pipeline::summary()
  ScanSum scans;          //!< so far
  bool is_last = false;   //!< the run is stopped behind it: SlamRun::finish() leaves it
};

/** Schedules checkpoints, and passes the front end's part from its thread to that of the back
 * end. */
class Checkpoints
{
 public:
  /** \param seconds between checkpoints; 0: none. */
  explicit Checkpoints(double seconds) : seconds_(seconds) {}

  // Called in the front end's thread:
  /** Whether a checkpoint is due; if so, schedules the next one.
   * \param at_once it is due now, unless checkpoints are off */
  [[nodiscard]] bool due(bool at_once);
  void begin(std::size_t frame, BegunCheckpoint begun);

  // Called in the back end's thread:
  /** Records the duration of a checkpoint [s]: the interval is adapted, so that checkpoints take at
   * most a twentieth of the time for any size of the state. */
  void recordDuration(double seconds) { cost_ = seconds; }
  /** What was begun at this frame. */
  [[nodiscard]] std::optional<BegunCheckpoint> take(std::size_t frame);

 private:
  double seconds_;
  std::atomic<double> cost_ = 0;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::mutex mutex_;
  std::map<std::size_t, BegunCheckpoint> begun_;  //!< by Frame::index
};
}  // namespace dyslam
