// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam
{
/** SemanticKITTI's moving classes: 252 car, 253 bicyclist, 254 person, 255 motorcyclist, 256 rail,
 * 257 bus, 258 truck, 259 other vehicle; and 251 where only moving is known. The class is in the
 * label's low 16 bits, the instance in the high. */
[[nodiscard]] constexpr bool isMovingLabel(std::uint32_t label)
{
  return (label & 0xffffU) >= 251 && (label & 0xffffU) <= 259;
}

/** Unlabelled (0) and outlier (1) points: no metric or loss may use them. */
[[nodiscard]] constexpr bool isIgnoredLabel(std::uint32_t label)
{
  return (label & 0xffffU) <= 1;
}
}  // namespace dyslam
