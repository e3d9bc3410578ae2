// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Objects.h>
#include <dyslam/tracking/DetectionNoise.h>

#include <vector>

namespace dyslam
{
/** Detections from boxes of whole objects, moving or not, that another program found in a scan;
 * with the indices of the cloud points in each box, and the covariance of its noise. \param boxes
 * lidar frame at the scan's stamp \return vehicle frame, in the order of the boxes. */
[[nodiscard]] std::vector<Detection> detectionsOf(const std::vector<LabelledBox>& boxes,
                                                  const Frame& frame,
                                                  const DetectionNoiseOptions& noise);
}  // namespace dyslam
