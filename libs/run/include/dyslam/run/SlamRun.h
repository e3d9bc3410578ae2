// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/run/SlamRunReport.h>
#include <dyslam/run/SlamRunSettings.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
class Pipeline;
struct RawlogSourceOptions;
struct BegunCheckpoint;
struct RunToResume;

/** Whether and why a run ended before the last scan of its recording. */
struct EarlyEnd
{
  bool is_stopped = false;  //!< on request (SlamRunSettings::stop)
  std::string damage;       //!< error that ended the run; empty if there was none
};

/** The pipeline and the outputs of a run, for programs that supply the frames themselves. */
class SlamRun
{
 public:
  /** Builds all stages and outputs; nothing is written yet. \throws UserError for a bad config. */
  explicit SlamRun(const SlamRunSettings& settings);
  ~SlamRun();

  /** All sections and keys that the stages and outputs have loaded, as in effective.ini. */
  [[nodiscard]] Config effective() const;
  [[nodiscard]] Pipeline& pipeline();
  /** Options of the ini section [input]. */
  [[nodiscard]] const RawlogSourceOptions& input() const;

  /** To be called before the first frame: creates the output folder and removes files of an earlier
   * run. \throws UserError if it cannot be written. */
  void open();
  /** Called instead of open(): sets pipeline, statistics and outputs to a saved state.
   * \throws UserError if the state does not fit. */
  void resume(RunToResume& saved);
  /** Between two frames: writes a checkpoint: the results so far and the state. Of the front end,
   * which may process later frames meanwhile, it has what was begun after the last frame only. */
  void checkpoint(const BegunCheckpoint& begun);
  /** `output.checkpoint_seconds` */
  [[nodiscard]] double checkpointSeconds() const;
  /** Adds a frame that the pipeline has processed to the statistics and the outputs. */
  void add(Frame frame);
  [[nodiscard]] std::size_t frames() const;
  /** Records how long a thread of the caller waited for others [s], for the report. */
  void noteWait(const std::string& thread, double seconds);
  /** Tells SlamRunSettings::after_scans, if there were scans. */
  void announce(const std::string& work) const;
  /** Called after Pipeline::finish(): writes all results that are known only at the end.
   * \param source_warnings warnings about the recording
   * \throws UserError for an early end, and if files could not be written (others are written). */
  SlamRunReport finish(const std::vector<std::string>& source_warnings, const EarlyEnd& end);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};
}  // namespace dyslam
