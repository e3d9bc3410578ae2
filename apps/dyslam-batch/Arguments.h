// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/batch/Manifest.h>
#include <dyslam/batch/Recordings.h>
#include <dyslam/io/RecordingOptions.h>
#include <dyslam/io/ScanRange.h>

#include <string>
#include <vector>

namespace CLI
{
class App;
}

namespace dyslam::batch
{
/** Arguments of dyslam-batch. */
struct Arguments
{
  std::vector<std::string> entries;  //!< recordings, see listRecordings()
  std::string output;
  std::string config;
  std::string scratch;
  std::string shard;
  std::string slurm_options;
  std::vector<std::string> assignments;
  RecordingOptions conversion;  //!< options for recordings that are no rawlogs
  bool labels = false;
  bool probabilities = false;
  bool static_scans = false;
  ScanRange range;  //!< of each recording, by number only
  int passes = 1;
  int jobs = 0;
  double memory = 0;  //!< memory of all runs together [GiB]; 0: automatic
  bool quiet = false;
  bool no_summary = false;
  bool gather = false;
  bool slurm = false;
};

void declare(CLI::App& app, Arguments& a);

/** The arguments of dyslam that change results, but for those of the conversion, as words of a
 * command line. */
[[nodiscard]] std::vector<std::string> runArguments(const Arguments& a);

/** \throws UserError if a given option applies to none of the recordings, or does not apply to one
 * that is converted. */
void requireFittingConversion(const RecordingOptions& conversion,
                              const std::vector<Recording>& recordings);

/** Common data of all runs: version and checksum of the program, with the calibration and the files
 * that settings name, and the settings, with the values
 * of the ini instead of its name. \param program path of dyslam \throws UserError. */
[[nodiscard]] Work commonWork(const Arguments& a, const std::string& program);
}  // namespace dyslam::batch
