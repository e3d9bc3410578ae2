// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/Converters.h>

#include <filesystem>
#include <string>
#include <vector>

#include "KittiLayout.h"

namespace dyslam
{
struct KittiScans
{
  std::filesystem::path folder;             //!< of the recording: the input, or a drive within it
  std::string sequence;                     //!< of tracking's official layout; empty in all others
  std::vector<KittiLayout::Entry> entries;  //!< scan and number
};

/** Finds the scans of a recording. \param given its folder; for KITTI-360 also the folder of the
 * drives, or that of the data set. \throws UserError if there are none; it names the right kind or
 * folder where the layout is another one. */
[[nodiscard]] KittiScans findKittiScans(const std::filesystem::path& given,
                                        const KittiConverterOptions& options);
}  // namespace dyslam
