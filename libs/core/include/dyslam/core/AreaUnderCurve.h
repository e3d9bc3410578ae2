// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace dyslam
{
/** Area under the ROC curve of a score that is to tell two classes apart: probability that a sample
 * of `low` has the lower score than one of `high`; ties count half. NaN if either is empty. */
[[nodiscard]] double areaUnderCurve(std::vector<float> high, const std::vector<float>& low);
}  // namespace dyslam
