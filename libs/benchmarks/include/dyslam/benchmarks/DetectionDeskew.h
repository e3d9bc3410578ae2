// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Deskew.h>
#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <vector>

namespace dyslam
{
/** Time at which a spinning lidar, whose scans are stamped at half the sweep, swept a place,
 * relative to the stamp [s]: -azimuth / (2 pi) * period for the default, which is KITTI's.
 * sweepFraction() is the same in single precision, counted from the start.
 * \param azimuth counter-clockwise from straight ahead [rad] \param period of a revolution [s] */
[[nodiscard]] double sweepTime(double azimuth, double period, const SweepModel& model = {});

/** Corrects a box from a scan without deskewing for the ego-motion, as if the object were static.
 * \param box vehicle frame (straight ahead: +x), at the time it was swept
 * \param T_now_next ego-motion over `interval` [s], taken as constant
 * \param period of a revolution [s]
 * \return vehicle frame at the scan's stamp. \throws std::invalid_argument unless period and
 * interval are positive. */
[[nodiscard]] Box deskewed(const Box& box,
                           const Pose& T_now_next,
                           double interval,
                           double period,
                           const SweepModel& model = {});
/** The inverse, to first order in the change of azimuth: from a box at the scan's stamp to the box
 * in the distorted scan.
 */
[[nodiscard]] Box skewed(const Box& box,
                         const Pose& T_now_next,
                         double interval,
                         double period,
                         const SweepModel& model = {});

/** deskewed() for all detections; their covariances are rotated accordingly. */
void deskewDetections(std::vector<Detection>& detections,
                      const Pose& T_now_next,
                      double interval,
                      double period,
                      const SweepModel& model = {});
}  // namespace dyslam
