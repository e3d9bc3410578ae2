// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/run/SlamRun.h>

#include <cstddef>
#include <functional>
#include <string>

namespace dyslam
{
/** Called after each frame of a run. \param fraction share of the work that is done, in [0, 1]
 * \param frames number of frames so far */
using FrameCallback = std::function<void(double fraction, std::size_t frames)>;

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

// Parts of a run, for others that pass the frames to SlamRun.

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
}  // namespace dyslam
