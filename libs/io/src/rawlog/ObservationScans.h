// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>
#include <mrpt/obs/CObservation.h>

#include <string>

namespace dyslam
{
/** External files of observations. */
struct ExternalFiles
{
  std::string folder;     //!< that their names are relative to
  bool anywhere = false;  //!< names that lead out of the folder are read, too
};

/** Suffix of the label of the observation that carries per-point time and ring. */
constexpr const char* time_ring_suffix = "_time_ring";

/** True for the kinds of observation that scanFromObservation() reads. */
[[nodiscard]] bool is3dScan(const mrpt::obs::CObservation& observation);

/** The observation's points in the sensor's frame; stamp, label and T_vehicle_lidar filled.
 * Intensities are as stored: 0..255 for Velodyne and rotating scans is scaled to [0, 1] here,
 * clouds are left alone.
 * \throws UserError, for external files outside of their folder too, or whatever MRPT throws for
 * damaged data. */
[[nodiscard]] Scan scanFromObservation(mrpt::obs::CObservation& observation,
                                       const ExternalFiles& external);

/** Puts the companion's (time, ring, 0) into the scan. False if it does not fit. */
[[nodiscard]] bool applyTimeRing(mrpt::obs::CObservation& companion,
                                 const ExternalFiles& external,
                                 Scan& scan);
}  // namespace dyslam
