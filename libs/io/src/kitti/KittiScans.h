// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/KittiConverter.h>

#include <cstddef>
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

/** The line of each scan in a file that has one for each frame number, or for each scan there is.
 * \param path of the file \param count its lines \param what of what, for the message
 * \throws UserError if neither can be told from the other. */
[[nodiscard]] std::vector<std::size_t> linesOfScans(const std::vector<KittiLayout::Entry>& entries,
                                                    const std::string& path,
                                                    std::size_t count,
                                                    const std::string& what);
}  // namespace dyslam
