// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PriorMapOptions.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
/** Points of the prior map, its frame [m]; none if no file is given. \throws UserError for a file
 * that is no map, and for coordinates too far from the origin for float32. */
[[nodiscard]] std::vector<Eigen::Vector3f> readPriorMap(const PriorMapOptions& options);
}  // namespace dyslam
