// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace dyslam
{
/** Area under the ROC curve of a score that separates two classes: probability that a random value
 * of `low` is below a random value of `high`; ties count half. NaN if either is empty. */
[[nodiscard]] double areaUnderCurve(std::vector<float> high, const std::vector<float>& low);
}  // namespace dyslam
