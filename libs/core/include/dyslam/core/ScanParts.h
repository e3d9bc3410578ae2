// SPDX-License-Identifier: BSD-3-Clause
// Scans that are merged from several lidars of a vehicle.
#pragma once

#include <dyslam/core/Scan.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace dyslam
{
/** Appends the scan of a further lidar: points in the lidar frame of `scan`, times after the stamp
 * of `scan`, ring numbers unique to the lidar. Times are kept if `scan` has them; points of a
 * `further` scan without times get its stamp. Rings are kept if both scans have them. If only one
 * scan has intensities, those of the other are 0.
 * \param lidar number of the further lidar, from 1 */
void appendScan(const Scan& further, std::size_t lidar, Scan& scan);

/** Number of lidars that a scan is merged from: its parts and its first lidar. */
[[nodiscard]] inline std::size_t partCount(const Scan& scan)
{
  return scan.parts.size() + 1;
}

/** Points [begin, end) of a scan, or of its cloud, that one lidar measured. */
struct LidarRange
{
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t lidar = 0;                    //!< ScanPart::lidar; 0: the first lidar
  Pose T_vehicle_lidar = Pose::Identity();  //!< mounting of the lidar
  double stamp = 0;  //!< stamp of the lidar's scan, relative to Scan::stamp [s]

  /** The lidar's origin, vehicle frame [m]. */
  [[nodiscard]] Eigen::Vector3f sensor() const
  {
    return T_vehicle_lidar.translation().cast<float>();
  }
};

/** Calls `use` for each lidar of a scan, the first one first, with its part (points in that lidar's
 * frame, that lidar's mounting, but stamp and times of the whole scan) and the range of its points
 * in the whole scan. A scan of one lidar is passed without copying it. */
void forEachPart(const Scan& scan,
                 const std::function<void(const Scan& part, const LidarRange& range)>& use);

/** A copy of the scan with the points of the first lidar only. */
[[nodiscard]] Scan ownScan(const Scan& scan);

/** The points of a cloud by lidar: one range, maybe empty, for each lidar of its scan. Without
 * Cloud::source all points count as the first lidar's. */
[[nodiscard]] std::vector<LidarRange> lidarRanges(const Scan& scan, const Cloud& cloud);

/** Number of points at the beginning of the cloud that the first lidar measured. */
[[nodiscard]] std::size_t ownPoints(const Scan& scan, const Cloud& cloud);
}  // namespace dyslam
