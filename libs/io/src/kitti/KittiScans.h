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
  std::string sequence;                     //!< of tracking's official layout; empty in all others
  std::vector<KittiLayout::Entry> entries;  //!< scan and number
};

/** Finds the scans of a recording. \throws UserError if there are none; it names the right kind or
 * folder where the layout is another one. */
[[nodiscard]] KittiScans findKittiScans(const std::filesystem::path& input,
                                        const KittiConverterOptions& options);
}  // namespace dyslam
