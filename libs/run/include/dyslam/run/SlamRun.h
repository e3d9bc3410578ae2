// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Georeference.h>
#include <dyslam/core/Gravity.h>
#include <dyslam/core/PriorMapFit.h>

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
struct BegunCheckpoint;
struct RunToResume;

/** Settings of one run that are not in the config. */
struct SlamRunSettings
{
  std::string rawlog;         //!< path of the input
  std::string output_folder;  //!< created if missing; files of an earlier run are replaced
  Config config;
  std::vector<std::string> inputs;    //!< other files that are read, which are never replaced
  std::string sensor;                 //!< description of the sensor, for the report
  std::vector<std::string> warnings;  //!< on conversion and settings, for the report
  bool force = false;                 //!< replace also files that no run wrote
  bool probabilities = false;         //!< write the moving probability of each point, .bin files
  bool static_scans = false;   //!< write the scans without moving points: .bin files and a rawlog
  bool labels = false;         //!< write labels/NNNNNN.label, one entry per point of the input scan
  std::string profile_csv;     //!< times of every stage, if not empty
  double first_pass_time = 0;  //!< time of an earlier pass, part of the run's time [s]
  /** Called before the output folder is opened (true: the folder is not changed) and after every
   * scan (true: the run ends after the few scans that are being processed). */
  std::function<bool()> stop;
  /** Receives warnings immediately that the report has, too, and which outputs have failed; called
   * from any thread. */
  std::function<void(const std::string&)> warn;
  /** Receives what the run does after the last scan, which may take a while, such as "writing the
   * results"; called from the thread of the run. */
  std::function<void(const std::string&)> after_scans;
};

/** Called after each frame of a run. \param fraction share of the work that is done, in [0, 1]
 * \param frames number of frames so far */
using FrameCallback = std::function<void(double fraction, std::size_t frames)>;

/** Result of a run, as in report.json. */
struct SlamRunReport
{
  std::string method;  //!< stages in use, e.g. "residual + constant_velocity + point_to_plane"
  std::size_t frames = 0;
  std::size_t unconverged = 0;      //!< number of frames whose motion was predicted, not measured
  std::size_t odometry_failed = 0;  //!< number of frames on which odometry.method found no motion
  std::size_t keyframes = 0;
  std::size_t loops = 0;           //!< number of loops in use
  std::size_t loops_left_out = 0;  //!< number of loops that contradict the others and the odometry
  /** Pose of the map on the earth; nothing if satellite positions don't show it. */
  std::optional<Georeference> georeference;
  std::optional<Gravity> gravity;
  std::optional<PriorMapFit> prior_map;  //!< nothing without a prior map
  std::size_t tracks = 0;                //!< number of confirmed moving objects
  std::size_t map_points = 0;
  double path_length = 0;  //!< length of the trajectory [m]
  double ms_per_scan = 0;  //!< mean time of all stages, without reading and writing files
  /** From the construction of SlamRun to its last file, including the first of two passes [s]. */
  double run_time = 0;
  double first_pass_time = 0;  //!< part of run_time for the first of two passes [s]
  double recording_time = 0;   //!< duration of the processed part of the recording [s]
  bool has_reference = false;  //!< the recording had ground truth; reference_tum.txt was written
  /** How far the result can be trusted: usable, doubtful (the warnings say why) or unusable. */
  std::string verdict = "usable";
  /** Why the result is unusable: most scans could not be registered; empty if it is usable. */
  std::string failure;
  /** Why the run ended before the last scan (stopped, or the recording is damaged); empty if it did
   * not. Also one of the warnings. */
  std::string ended_early;
  /** Advice to process the recording in two passes because of dense traffic; else empty. Also one
   * of the warnings. */
  std::string second_pass_advice;
  std::vector<std::string> warnings;
  std::vector<std::string> files;  //!< names of the files written to the output folder

  /** Recording time over run time; 1 and more is real time. 0 if unknown. */
  [[nodiscard]] double realtimeFactor() const
  {
    return run_time > 0 ? recording_time / run_time : 0;
  }
};

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

  /** All sections and keys that the stages and outputs load, as in effective.ini, with their
   * defaults. Builds a run to find them. */
  [[nodiscard]] static Config defaults();
  /** Names of the sections of defaults(), sorted. */
  [[nodiscard]] static std::vector<std::string> sections();

  /** Checks the names of settings, not their values, before the recording is at hand.
   * \throws UserError for a section or key that no run has, as the constructor does; it names the
   * sections that have such a key */
  static void requireKnownNames(const Config& config);

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

/** Ends a run between two of its steps. \param when which ones, for the message
 * \throws UserError if SlamRunSettings::stop is true. */
void requireNotStopped(const SlamRunSettings& settings,
                       const std::string& when = "before the first scan");

/** The part of a run between SlamRun::open() and SlamRun::finish(): an exception becomes
 * EarlyEnd::damage, so that the results of the frames before it are kept. \param replay passes
 * every frame to the run and returns whether it was stopped \param finish ends the pipeline, also
 * after an exception of `replay`, which is thrown again if the run has no frames then */
[[nodiscard]] EarlyEnd replayToTheEnd(const SlamRun& run,
                                      const std::function<bool()>& replay,
                                      const std::function<void()>& finish);

/** Replays a rawlog through the pipeline and fills a folder with the results.
 *
 * If the recording turns out damaged halfway, or the run is stopped, complete results of the frames
 * before are written, then the error is thrown. If a file cannot be written, all others are written
 * and report.json names it, then the error is thrown. A stopped run also leaves a checkpoint,
 * unless `output.checkpoint_seconds` is 0.
 * \throws UserError for bad input, config or output folder. */
SlamRunReport runSlam(const SlamRunSettings& settings, const FrameCallback& on_frame = {});

/** Resumes a run that was stopped or killed from its last checkpoint. The files become byte for
 * byte those of an uninterrupted run, except for times in the reports.
 *
 * Settings and recording are those that the run had; its scans are read again up to the checkpoint
 * and must be the same. The working directory may be another than that of the run, and the output
 * folder may have been moved.
 * \param given `output_folder` of the run; `rawlog` if the recording has been moved, else empty;
 *   `config` with settings that have to be equal to the run's; `stop` and `profile_csv`
 * \throws UserError as runSlam(), and if there is nothing to resume, the state is damaged, or
 *   recording, settings or program differ. Nothing is removed then. */
SlamRunReport resumeSlam(const SlamRunSettings& given, const FrameCallback& on_frame = {});

/** Whether the output folder of a run has a checkpoint, which resumeSlam() continues from. */
[[nodiscard]] bool hasCheckpoint(const std::string& output_folder);

/** All settings of the run whose checkpoint is in the folder.
 * \throws UserError if there is no checkpoint, or it cannot be used. */
[[nodiscard]] Config settingsOfCheckpoint(const std::string& output_folder);
}  // namespace dyslam
