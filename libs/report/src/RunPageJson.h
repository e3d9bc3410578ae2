// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/report/RunPage.h>

#include <nlohmann/json.hpp>

#include "PackedPoints.h"

namespace dyslam
{
/** The page's data but for the bytes of points and picture. web/src/data.js reads it.
 * \param max_scans series are of so many scans at most, evenly taken; so many loops, too */
[[nodiscard]] nlohmann::ordered_json runPageJson(const RunPage& page,
                                                 const PackedPoints& points,
                                                 std::size_t max_scans);
}  // namespace dyslam
