// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/LabelFiles.h>

#include <vector>

namespace dyslam
{
/** Labels the returns that are nearer than every point of the cloud (preprocess.min_range,
 * own_vehicle_range) as moving if they continue a reported moving object: the near part of a
 * cyclist who passes the sensor.
 *
 * Cells of 0.5 m take the label of most points in the cells around them, from the cloud inwards.
 * Returns that continue nothing (the sensor's own vehicle) or a static surface stay unlabelled.
 * \param labels label of every point of frame.scan; final for points in the cloud */
void labelNearReturns(const Frame& frame, std::vector<Label>& labels);
}  // namespace dyslam
