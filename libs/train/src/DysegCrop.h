// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/nets/BevScan.h>
#include <dyslam/train/DysegData.h>

namespace dyslam
{
/** Draws the centre of a training crop, in the frame of the current scan [m]: mostly near a moving
 * object that the crop then contains, if there is one; else random, near the sensor more often.
 * \param grid the whole grid \param crop smaller grid of the same cell size \param farthest largest
 * distance of the centre from the sensor, in x and in y [m] */
[[nodiscard]] Eigen::Vector2f drawCentre(const DysegSample& sample,
                                         const BevOptions& grid,
                                         const BevOptions& crop,
                                         double farthest,
                                         RandomDraws& draws);
}  // namespace dyslam
