// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/SlamRunSettings.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Identity and progress of the run that a state belongs to. */
struct SavedRun
{
  std::string version;  //!< version of the program
  std::string rawlog;   //!< absolute path
  std::uint64_t rawlog_size = 0;
  bool rawlog_grew = false;  //!< it was still being written: it may have become larger
  std::string settings;      //!< all of them, as an ini
  /** Second of two passes: `dyseg.labels` is keptLabelsOf() the output folder, also if that has
   * been moved. */
  bool is_second_pass = false;
  std::vector<std::string> inputs;  //!< absolute path of the ini that was given; empty: none
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
}  // namespace dyslam
