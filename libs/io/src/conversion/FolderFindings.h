// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/io/ScanConverter.h>

#include <cstddef>
#include <string>
#include <vector>

#include "LengthFindings.h"
#include "ScanSink.h"

namespace dyslam
{
/** What is unusual about the scans of a folder. */
struct FolderFindings
{
  bool assumed_times = false;  //!< scans that are taken as equally far apart
  std::size_t empty = 0;       //!< files without points
  std::string first_empty;
  std::string first_with_points;
  double odd_intensities = 0;  //!< share of those of that file that no lidar gives
  LengthFindings lengths;      //!< of that file

  /** Takes the next scan. \param has_stamp whether it has a time of its own \throws UserError if
   * the first file with points has no scan of a lidar. */
  void add(const Scan& scan, bool has_stamp, const std::string& file);
};

/** Warns of what was found. \param input folder of the files */
void warnAbout(const FolderFindings& findings,
               const std::string& input,
               const std::vector<std::string>& files,
               const ScanConverterOptions& options,
               ScanSink& sink);
}  // namespace dyslam
