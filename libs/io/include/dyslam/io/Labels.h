// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Labels.h>

#include <cstdint>
#include <string>
#include <vector>

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

/** A `.label` file: little-endian uint32 per point. \throws UserError. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path);
/** \param expected the number of points of the scan. \throws UserError if the file has another. */
[[nodiscard]] std::vector<Label> readLabels(const std::string& path, std::size_t expected);
void writeLabels(const std::string& path, const std::vector<Label>& labels);
}  // namespace dyslam
