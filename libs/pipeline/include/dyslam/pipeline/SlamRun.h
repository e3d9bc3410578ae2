// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Georeference.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
class Pipeline;
struct RawlogSourceOptions;
class Checkpoints;
class ScanSum;
struct RunToResume;

/** Settings of one run. Everything else is in the config. */
struct SlamRunSettings
{
  std::string rawlog;         //!< input
  std::string output_folder;  //!< made if missing; files of an earlier run in it are replaced
  Config config;
  std::vector<std::string> inputs;    //!< other files that are read: never replaced
  std::string sensor;                 //!< what the recording shows of it; for the report
  std::vector<std::string> warnings;  //!< about the settings; for the report
  bool force = false;                 //!< replace files that no run wrote
  bool probabilities = false;         //!< write the moving probability of each point, .bin files
  bool static_scans = false;   //!< write the scans without moving points: .bin files and a rawlog
  bool labels = false;         //!< write labels/NNNNNN.label, one entry per point of the input scan
  std::string profile_csv;     //!< times of every stage, if not empty
  double first_pass_time = 0;  //!< that a pass before this one took, part of the run's time [s]
  /** Polled before the output folder is opened, where true leaves it as it is, and after every
   * scan: true ends the run after the scans that are in work then, a few at most. */
  std::function<bool()> stop;
  /** Gets warnings that should not wait for the report, which has them too; from any thread. */
  std::function<void(const std::string&)> warn;
};

/** Result of a run; the same is in report.json. */
struct SlamRunReport
{
  std::string method;  //!< stages in use, e.g. "residual + constant_velocity + point_to_plane"
  std::size_t frames = 0;
  std::size_t unconverged = 0;      //!< frames whose motion was predicted, not measured
  std::size_t odometry_failed = 0;  //!< frames on which odometry.method found no motion
  std::size_t keyframes = 0;
  std::size_t loops = 0;           //!< in use
  std::size_t loops_left_out = 0;  //!< that contradict these and the odometry
  /** Where the map is on the earth; nothing without positions that show it. */
  std::optional<Georeference> georeference;
  std::size_t tracks = 0;  //!< confirmed moving objects
  std::size_t map_points = 0;
  double path_length = 0;      //!< [m]
  double ms_per_scan = 0;      //!< mean of all stages, without reading and writing files
  double run_time = 0;         //!< from the construction of SlamRun to its last file, and that of
                               //!< the first of two passes [s]
  double first_pass_time = 0;  //!< of these [s]
  double recording_time = 0;   //!< of the scans that were processed [s]
  bool has_reference = false;  //!< the recording had ground truth; reference_tum.txt was written
  /** How far the result can be trusted: usable, doubtful (the warnings say why) or unusable. */
  std::string verdict = "usable";
  /** Why the result is unusable: most scans could not be registered; empty if it is usable. */
  std::string failure;
  /** Why the run ended before its last scan: stopped, or the recording is damaged; empty if it did
   * not. Among the warnings, too. */
  std::string ended_early;
  /** Advice to process the recording in two passes, as the traffic is dense; empty without. Among
   * the warnings, too. */
  std::string second_pass_advice;
  std::vector<std::string> warnings;
  std::vector<std::string> files;  //!< written, in the output folder

  /** Recording time over run time: above 1, the run kept up with the sensor. 0 if unknown. */
  [[nodiscard]] double realtimeFactor() const
  {
    return run_time > 0 ? recording_time / run_time : 0;
  }
};

/** Whether and why a run ended before the last scan of its recording. */
struct EarlyEnd
{
  bool is_stopped = false;  //!< on request (SlamRunSettings::stop)
  std::string damage;       //!< error that ended it; empty if there was none
};

/** The pipeline and the results of a run, for programs that hand over the frames themselves. */
class SlamRun
{
 public:
  /** Builds all stages and outputs; nothing is written yet. \throws UserError for a bad config. */
  explicit SlamRun(const SlamRunSettings& settings);
  ~SlamRun();

  /** Names of the ini sections that effective.ini of every run has, sorted: those that the stages
   * and outputs load. Builds a run with the default settings to find them. */
  [[nodiscard]] static std::vector<std::string> sections();

  [[nodiscard]] Pipeline& pipeline();
  /** Section [input]. */
  [[nodiscard]] const RawlogSourceOptions& input() const;

  /** Before the first frame: makes the output folder, and removes what an earlier run left in it.
   * \throws UserError if it cannot be written. */
  void open();
  /** Instead of open(): sets pipeline, counts and outputs to a saved state.
   * \throws UserError if that cannot be. */
  void resume(RunToResume& saved);
  /** Between two frames: writes a checkpoint: the results so far and the state.
   * \param front_end Pipeline::exchangeFrontEndState() after the last frame \param scans so far
   * \param is_last the run is stopped here: finish() leaves the checkpoint for resumeSlam() */
  void checkpoint(const std::string& front_end, const ScanSum& scans, bool is_last = false);
  /** `output.checkpoint_seconds` */
  [[nodiscard]] double checkpointSeconds() const;
  /** A frame that the pipeline has processed: counted, and handed to the outputs. */
  void add(Frame frame);
  [[nodiscard]] std::size_t frames() const;
  /** Records for the report how long a thread of the caller has waited for others [s]. */
  void noteWait(const std::string& thread, double seconds);
  /** Share of the work done, given the share of the file read. */
  [[nodiscard]] double progress(double read) const;
  /** After Pipeline::finish(): writes all results that are known at the end only.
   * \param source_warnings about the recording
   * \throws UserError for an early end, and if files could not be written: the others are. */
  SlamRunReport finish(const std::vector<std::string>& source_warnings, const EarlyEnd& end);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/** \throws UserError if the run is to end before it has changed anything (SlamRunSettings::stop).
 */
void requireNotStopped(const SlamRunSettings& settings);

/** The part of a run between SlamRun::open() and SlamRun::finish(): an exception, also of a
 * library, is the damage of an early end, so that the frames before it are kept. \param replay
 * hands every frame to the run and returns whether it was stopped \param finish ends the pipeline,
 * also after an exception of `replay`, which is thrown again if the run has no frames then. */
[[nodiscard]] EarlyEnd replayToTheEnd(const SlamRun& run,
                                      const std::function<bool()>& replay,
                                      const std::function<void()>& finish);

/** Replays a rawlog through the pipeline and fills a folder with the results.
 *
 * A recording that turns out damaged halfway, and a run that is stopped, still leave complete
 * results of the frames before; then the error is thrown. So does a run one of whose files could
 * not be written: the others are, and report.json names those that are not. A
 * stopped run leaves a checkpoint, too, unless `output.checkpoint_seconds` is 0.
 * \param on_frame called after each frame with the share of the work done and the number of
 * frames. \throws UserError for bad input, config or output folder. */
SlamRunReport runSlam(const SlamRunSettings& settings,
                      const std::function<void(double, std::size_t)>& on_frame = {});

/** Goes on with a run that was stopped or killed, from its last checkpoint: the files become those
 * of a run that was not interrupted, byte for byte, but for times in the reports.
 *
 * Settings and recording are those that the run had; its scans are read again up to the checkpoint
 * and must be the same.
 * \param given `output_folder` of the run; `rawlog` if the recording has been moved, else empty;
 *   `config` with those of its settings that are to be checked; `stop` and `profile_csv`
 * \throws UserError as runSlam(), and if there is nothing to resume, the state is damaged, or
 *   recording, settings or program differ. Nothing is removed then. */
SlamRunReport resumeSlam(const SlamRunSettings& given,
                         const std::function<void(double, std::size_t)>& on_frame = {});

/** Whether the output folder of a run has a checkpoint, which resumeSlam() continues from. */
[[nodiscard]] bool hasCheckpoint(const std::string& output_folder);

/** All settings of the run whose checkpoint is in the folder.
 * \throws UserError if there is no checkpoint, or it cannot be used. */
[[nodiscard]] Config settingsOfCheckpoint(const std::string& output_folder);
}  // namespace dyslam
