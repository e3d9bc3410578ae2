// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <string>
#include <vector>

#include "ScanSink.h"

namespace dyslam
{
/** The files of a folder of scans. */
struct ScanFolder
{
  std::vector<std::string> files;  //!< point clouds, sorted by name
  std::vector<Pose> poses;         //!< T_world_lidar of each; empty: none were given
};

/** \throws UserError without scans, and for options that do not fit them. */
[[nodiscard]] ScanFolder findScanFolder(const std::string& input,
                                        const ScanConverterOptions& options);
/** Passes the scans of a folder to the sink. \throws UserError if one cannot be read, or if the
 * options leave none. */
void convertFolder(const std::string& input,
                   const ScanFolder& folder,
                   ScanSink& sink,
                   const ScanConverterOptions& options);
}  // namespace dyslam
