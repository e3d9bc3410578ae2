// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/KittiConverter.h>

#include <filesystem>
#include <string>

#include "KittiLayout.h"

namespace dyslam
{
/** Where the stamps of a KITTI recording are from. */
enum class KittiTimes
{
  assumed,  //!< equal steps, given or assumed
  of_file,
  of_raw  //!< velodyne_points/timestamps.txt: oxts has times of the same clock
};

/** Sets the stamps of the layout's entries by the options, else by the files that the recording
 * has, else by KITTI's usual rate. Appends notes and warnings.
 * \param folder of the recording \param sequence of tracking's official layout, or empty
 * \throws UserError. */
[[nodiscard]] KittiTimes readKittiTimes(const std::filesystem::path& folder,
                                        const std::string& sequence,
                                        const KittiConverterOptions& options,
                                        KittiLayout& layout);

/** Finds the times of the points that exportKitti() writes beside scans that are not deskewed.
 * Warns if only some scans have them. Not for scans that count as deskewed, whose times are not
 * used. \param folder of the recording */
void findPointTimes(const std::filesystem::path& folder, KittiLayout& layout);
}  // namespace dyslam
