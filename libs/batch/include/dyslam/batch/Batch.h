// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/batch/Manifest.h>
#include <dyslam/batch/Recordings.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace dyslam::batch
{
struct BatchSettings
{
  std::string output;                   //!< folder of the results, with a subfolder per recording
  std::string program;                  //!< path of dyslam
  std::vector<std::string> arguments;   //!< arguments of dyslam, but for -i, -o and --force
  std::vector<std::string> conversion;  //!< further arguments for recordings that are converted
  Work common;                          //!< settings, version and checksum of the program
  int jobs = 0;                         //!< number of runs at a time; 0: number of cores
  std::uint64_t memory = 0;  //!< memory for all runs at a time [bytes]; 0: what is available
  std::string config;        //!< the ini among the arguments; empty: none
  std::string scratch;       //!< folder to run in before results are moved; empty: none
  int attempts = 2;          //!< largest number of attempts of a run that fails
};

/** Result of a recording. */
struct BatchResult
{
  Recording recording;
  Manifest manifest;
  bool skipped = false;  //!< the recording was done before
};

/** Callbacks of a running batch; each may be empty. */
struct BatchWatch
{
  std::function<bool()> stop;  //!< polled, from several threads at a time: true ends the batch
  /** Gets the share of the bytes done and the number of recordings ended, a few times a second. */
  std::function<void(double, std::size_t)> progress;
  /** Gets each result when its run has ended, and the number of recordings ended; never called by
   * two threads at a time. */
  std::function<void(const BatchResult&, std::size_t ended)> ended;
};

/** Folder of the results of a recording. */
[[nodiscard]] std::string folderOf(const BatchSettings& settings, const Recording& recording);

/** Runs dyslam on every recording that is not done, as child processes, each on cores of its own.
 *
 * A run that failed is repeated after all others, up to `attempts` attempts in all, unless a signal
 * stopped this run alone or its results could not be written. \return one entry per recording, in
 * their order; recordings not reached before a stop are `unknown` or `running` \throws UserError if
 * the output folder cannot be made, if a recording is in the folder of its results, and if dyslam
 * refuses the settings that all runs have in common. */
std::vector<BatchResult> runBatch(const BatchSettings& settings,
                                  const std::vector<Recording>& recordings,
                                  const BatchWatch& watch);

/** The results of earlier runs, without running anything. */
[[nodiscard]] std::vector<BatchResult> readBatch(const BatchSettings& settings,
                                                 const std::vector<Recording>& recordings);
}  // namespace dyslam::batch
