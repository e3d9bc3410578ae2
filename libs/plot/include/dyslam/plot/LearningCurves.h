// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/LearningLog.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** PNG of one panel per column over the steps, with one curve per series. Series of more than 60
 * rows are drawn faintly, with their running mean over a fiftieth of the rows on top.
 * \throws std::invalid_argument for a log without rows or columns. */
[[nodiscard]] std::vector<std::uint8_t> renderLearningCurves(const LearningLog& log);
}  // namespace dyslam
