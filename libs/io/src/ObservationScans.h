// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <mrpt/obs/CObservation.h>

#include <string>

namespace dyslam
{
/** Suffix of the label of the observation that carries per-point time and ring. */
constexpr const char* time_ring_suffix = "_time_ring";

/** True for the kinds of observation that scanFromObservation() reads. */
[[nodiscard]] bool is3dScan(const mrpt::obs::CObservation& observation);

/** The observation's points in the sensor's frame; stamp, label and T_vehicle_lidar filled.
 * Intensities are as stored: 0..255 for Velodyne and rotating scans is scaled to [0, 1] here,
 * clouds are left alone.
 * \param external_folder where externally stored data lie.
 * \throws UserError, or whatever MRPT throws for damaged data. */
[[nodiscard]] Scan scanFromObservation(mrpt::obs::CObservation& observation,
                                       const std::string& external_folder);

/** Puts the companion's (time, ring, 0) into the scan. False if it does not fit. */
[[nodiscard]] bool applyTimeRing(mrpt::obs::CObservation& companion,
                                 const std::string& external_folder,
                                 Scan& scan);
}  // namespace dyslam
