// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "PlaceClassifier.h"
#include "Segments.h"

namespace dyslam
{
/** The places of a scan with the evidence of themselves, their neighbours and their segments.
 * \param evidence by place \param points of the scan, map frame [m] \param heights of them over the
 * ground [m] */
[[nodiscard]] std::vector<PlaceFeatures> placeFeatures(const Segments& segments,
                                                       const std::vector<PlaceEvidence>& evidence,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const std::vector<float>& heights);
}  // namespace dyslam
