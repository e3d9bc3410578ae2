// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "PlaceClassifier.h"
#include "Segments.h"

namespace dyslam
{
/** The features of every place of a scan: the evidence of the place itself, of its neighbours and
 * of its segment. \param evidence one per place \param points of the scan, odometry frame [m]
 * \param heights over the ground, one per point [m] */
[[nodiscard]] std::vector<PlaceFeatures> placeFeatures(const Segments& segments,
                                                       const std::vector<PlaceEvidence>& evidence,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const std::vector<float>& heights);
}  // namespace dyslam
