// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationPointCloud.h>

#include "ObservationScans.h"

namespace dyslam
{
/** Points and intensities of a cloud that is kept in a file of its own.
 * \throws UserError if the file lies outside of its folder, is missing or damaged. */
[[nodiscard]] Scan readExternalCloud(const mrpt::obs::CObservationPointCloud& observation,
                                     const ExternalFiles& external);

/** Fills in what a range scan keeps in files of its own, if it does. \throws as above, or whatever
 * MRPT throws. */
void loadExternalParts(mrpt::obs::CObservation3DRangeScan& observation,
                       const ExternalFiles& external);

/** The points of a map and their intensities, if they have some. */
[[nodiscard]] Scan scanFromPointsMap(const mrpt::maps::CPointsMap& map);
}  // namespace dyslam
