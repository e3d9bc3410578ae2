// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/io/KittiConverter.h>

#include <filesystem>
#include <string>

#include "KittiLayout.h"
#include "KittiTimes.h"

namespace dyslam
{
/** File or folder of the readings of a recording's GNSS/INS unit; empty if there is none.
 * \param folder of the recording \param sequence of tracking's official layout, or empty
 * \throws UserError if the one that the options name is not there. */
[[nodiscard]] std::string findOxts(const std::filesystem::path& folder,
                                   const std::string& sequence,
                                   const KittiConverterOptions& options);

/** Reads the samples of oxts that the options want (imu, gnss) into the layout.
 * \param path of oxts \param T_velo_imu its calibration \param times those of the scans
 * \throws UserError. */
void readOxtsSamples(const std::string& path,
                     const Pose& T_velo_imu,
                     KittiTimes times,
                     const KittiConverterOptions& options,
                     KittiLayout& layout);
}  // namespace dyslam
