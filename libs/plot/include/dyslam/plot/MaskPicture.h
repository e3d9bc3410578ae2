// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/MaskScan.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** PNG of the scan from above (80 m x 80 m, x up) and of the ROC curve if there is one. Returns are
 * grey, truly moving ones dark red; sampled points are blue (static) to red (moving), larger where
 * they truly move. */
[[nodiscard]] std::vector<std::uint8_t> renderMaskScan(const MaskScan& scan);
}  // namespace dyslam
