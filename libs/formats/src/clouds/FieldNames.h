// SPDX-License-Identifier: BSD-3-Clause
// Names that drivers and programs give to the fields of points, in files and messages, as
// plainFieldName() makes them. Of several in one cloud the first is taken.
#pragma once

#include <dyslam/base/Printable.h>

#include <array>
#include <string>

namespace dyslam
{
/** Reflectivity on a fixed scale, where a driver has it beside an intensity without one. */
inline constexpr const char* calibrated_intensity_name = "reflectivity";

inline constexpr std::array<const char*, 4> intensity_names{"intensity", calibrated_intensity_name,
                                                            "i", "reflectance"};
inline constexpr std::array<const char*, 6> time_names{"t",           "time",        "timestamp",
                                                       "offset_time", "time_offset", "time_stamp"};
inline constexpr std::array<const char*, 4> ring_names{"ring", "line", "channel", "laser_id"};

/** In lower case and without what CloudCompare puts before names: "intensity" for
 * "scalar_Intensity". */
[[nodiscard]] inline std::string plainFieldName(const std::string& name)
{
  const std::string prefix = "scalar_";
  const std::string low = lowered(name);
  return low.compare(0, prefix.size(), prefix) == 0 ? low.substr(prefix.size()) : low;
}
}  // namespace dyslam
