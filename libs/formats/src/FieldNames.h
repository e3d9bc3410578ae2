// SPDX-License-Identifier: BSD-3-Clause
// Names that drivers and programs give to the fields of points, in files and messages. Of several
// in one cloud the first is taken.
#pragma once

#include <array>

namespace dyslam
{
/** Reflectivity on a fixed scale, where a driver has it beside an intensity without one. */
inline constexpr const char* calibrated_intensity_name = "reflectivity";

inline constexpr std::array<const char*, 5> intensity_names{
    "intensity", "scalar_intensity", "scalar_Intensity", calibrated_intensity_name, "i"};
inline constexpr std::array<const char*, 6> time_names{"t",           "time",        "timestamp",
                                                       "offset_time", "time_offset", "time_stamp"};
inline constexpr std::array<const char*, 4> ring_names{"ring", "line", "channel", "laser_id"};
}  // namespace dyslam
