// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapping/StaticMap.h>

#include <cstddef>

namespace dyslam
{
/** The points of the cleaned map, in the map frame; if it has more than `most`, the first one of
 * each cube, whose side is enlarged until the limit is met. \throws std::invalid_argument if most
 * is 0. */
[[nodiscard]] MapPoints thinnedPoints(const StaticMap& map, std::size_t most);
}  // namespace dyslam
