// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

#include <vector>

namespace dyslam
{
/** The sweep of a spinning lidar whose scans are stamped when it faces straight ahead. */
struct Sweep
{
  double period = 0.1;    //!< duration of a revolution [s]
  bool clockwise = true;  //!< direction seen from above; Velodyne: clockwise
};

/** Time at which a place at `azimuth` (counter-clockwise from straight ahead [rad], in [-pi, pi])
 * was swept, relative to the scan's stamp [s]: -azimuth / (2 pi) * period for a clockwise sweep. */
[[nodiscard]] double sweepTime(double azimuth, const Sweep& sweep);

/** Corrects a box from a scan without deskewing for the ego-motion, as if the object were static.
 * \param box vehicle frame (straight ahead: +x), at the time it was swept
 * \param T_now_next ego-motion over `interval` [s], taken as constant
 * \return vehicle frame at the scan's stamp. \throws std::invalid_argument unless period and
 * interval are positive. */
[[nodiscard]] Box deskewed(const Box& box,
                           const Pose& T_now_next,
                           double interval,
                           const Sweep& sweep);
/** Inverse of deskewed(), to first order in the change of azimuth: box in the distorted scan of a
 * box at the scan's stamp.
 */
[[nodiscard]] Box skewed(const Box& box,
                         const Pose& T_now_next,
                         double interval,
                         const Sweep& sweep);

/** deskewed() for all detections; their covariances are rotated accordingly. */
void deskewDetections(std::vector<Detection>& detections,
                      const Pose& T_now_next,
                      double interval,
                      const Sweep& sweep);
}  // namespace dyslam
