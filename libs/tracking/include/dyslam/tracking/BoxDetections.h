// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Objects.h>
#include <dyslam/tracking/DetectionNoise.h>

#include <vector>

namespace dyslam
{
/** Detections from the boxes that another program found in a scan, of whole objects, moving or not:
 * with the points of the frame's cloud in each box, and the covariance of its noise.
 * \param boxes lidar frame at the scan's stamp
 * \return vehicle frame, in the order of the boxes. */
[[nodiscard]] std::vector<Detection> detectionsOf(const std::vector<LabelledBox>& boxes,
                                                  const Frame& frame,
                                                  const DetectionNoiseOptions& noise);
}  // namespace dyslam
