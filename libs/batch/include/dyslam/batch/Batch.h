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
  std::string output;                   //!< folder; each recording has one of its name in it
  std::string program;                  //!< path of dyslam
  std::vector<std::string> arguments;   //!< of dyslam, but for -i, -o and --force
  std::vector<std::string> conversion;  //!< further ones for recordings that dyslam converts
  Work common;                          //!< settings, version and checksum of the program
  int jobs = 0;                         //!< at once; 0: as many as there are cores
  std::uint64_t memory = 0;             //!< for all at once [bytes]; 0: what is available
  std::string config;                   //!< the ini among the arguments; or none
  std::string scratch;                  //!< folder to run in before results are moved; or none
  int attempts = 2;                     //!< of a run that fails
};

/** Result of a recording. */
struct BatchResult
{
  Recording recording;
  Manifest manifest;
  bool skipped = false;  //!< had been done before
};

/** Callbacks of a running batch; each may be empty. */
struct BatchWatch
{
  std::function<bool()> stop;  //!< polled, from several threads at a time: true ends the batch
  /** Gets the share of the bytes done and the number of recordings ended, a few times a second. */
  std::function<void(double, std::size_t)> progress;
  /** Gets each recording when it has ended, and how many have; never from two threads at a time. */
  std::function<void(const BatchResult&, std::size_t ended)> ended;
};

/** Folder of a recording's results. */
[[nodiscard]] std::string folderOf(const BatchSettings& settings, const Recording& recording);

/** Runs dyslam on every recording that is not done, as child processes, each on cores of its own.
 *
 * What failed is run again after all others, up to `attempts` times in all, unless it was stopped
 * by a signal of its own. \return one entry per recording, in their order; those not reached before
 * a stop are `unknown` or `running`. \throws UserError if the output folder cannot be made, and if
 * dyslam refuses the settings that all runs have in common. */
std::vector<BatchResult> runBatch(const BatchSettings& settings,
                                  const std::vector<Recording>& recordings,
                                  const BatchWatch& watch);

/** The results of earlier runs, without running anything. */
[[nodiscard]] std::vector<BatchResult> readBatch(const BatchSettings& settings,
                                                 const std::vector<Recording>& recordings);
}  // namespace dyslam::batch
