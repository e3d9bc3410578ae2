// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace dyslam
{
/** One label per point as SemanticKITTI packs it: class in the low 16 bits, instance in the high.
 */
using Label = std::uint32_t;

[[nodiscard]] constexpr std::uint16_t semanticOf(Label label)
{
  return static_cast<std::uint16_t>(label & 0xffffU);
}
[[nodiscard]] constexpr std::uint16_t instanceOf(Label label)
{
  return static_cast<std::uint16_t>(label >> 16U);
}
[[nodiscard]] constexpr Label makeLabel(std::uint16_t semantic, std::uint16_t instance)
{
  return (static_cast<Label>(instance) << 16U) | semantic;
}

/** Labels used where only moving or static is known, as in the SemanticKITTI-MOS benchmark. */
constexpr Label label_static = 9;
constexpr Label label_moving = 251;

/** SemanticKITTI's moving classes: 252 car, 253 bicyclist, 254 person, 255 motorcyclist, 256 rail,
 * 257 bus, 258 truck, 259 other vehicle; and 251 where only moving is known. */
[[nodiscard]] constexpr bool isMovingLabel(Label label)
{
  return semanticOf(label) >= 251 && semanticOf(label) <= 259;
}

/** Unlabelled (0) and outlier (1) points: no metric or loss may use them. */
[[nodiscard]] constexpr bool isIgnoredLabel(Label label)
{
  return semanticOf(label) <= 1;
}
}  // namespace dyslam
