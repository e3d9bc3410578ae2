// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/dyseg/ResidualSegmenter.h>

namespace dyslam
{
/** From votes of single points (> 0 moving, < 0 static, 0 unknown) to whole moving objects.
 *
 * Points above ground are put in a grid seen from above; cells in which moving votes prevail are
 * joined with their neighbours, and a joined object counts if it is large and sure enough. \return
 * one flag per point: part of a moving object.
 */
[[nodiscard]] std::vector<bool> movingCells(const std::vector<Eigen::Vector3f>& points,
                                            const std::vector<std::int8_t>& votes,
                                            const ResidualSegmenterOptions& options);
}  // namespace dyslam
