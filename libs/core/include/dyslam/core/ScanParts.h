// SPDX-License-Identifier: BSD-3-Clause
// Scans of a vehicle with several lidars.
#pragma once

#include <dyslam/core/Scan.h>

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <vector>

namespace dyslam
{
/** Adds the scan of a further lidar: its points in the scan's lidar frame, times from the scan's
 * stamp, rings of their own. Times are kept if the scan has them: points of a further one without
 * are as of its stamp. Rings are kept if both have them; where only one has intensities, those of
 * the other are 0.
 * \param lidar number of the further lidar, from 1 */
void appendScan(const Scan& further, std::size_t lidar, Scan& scan);

/** Number of the scan's parts, its own points included. */
[[nodiscard]] inline std::size_t partCount(const Scan& scan)
{
  return scan.parts.size() + 1;
}

/** Points [begin, end) of a scan, or of the cloud made from it, that one lidar measured. */
struct LidarRange
{
  std::size_t begin = 0;
  std::size_t end = 0;
  std::size_t lidar = 0;                    //!< ScanPart::lidar; 0: the scan's own
  Pose T_vehicle_lidar = Pose::Identity();  //!< mounting of the lidar
  double stamp = 0;                         //!< of the lidar's own scan, after Scan::stamp [s]

  /** The lidar's origin, vehicle frame [m]. */
  [[nodiscard]] Eigen::Vector3f sensor() const
  {
    return T_vehicle_lidar.translation().cast<float>();
  }
};

/** Calls `use` for each part of a scan, its own first: the part as its lidar measured it, with
 * points in that lidar's frame and its mounting, but the stamp and times of the whole scan; and its
 * points in the whole. A scan without further ones is passed as it is, not copied. */
void forEachPart(const Scan& scan,
                 const std::function<void(const Scan& part, const LidarRange& range)>& use);

/** A copy of the scan's own points alone, without those of further lidars. */
[[nodiscard]] Scan ownScan(const Scan& scan);

/** The points of a cloud by lidar: one range for each part of its scan, some maybe empty. The
 * points of a cloud without sources all count as the scan's own. */
[[nodiscard]] std::vector<LidarRange> lidarRanges(const Scan& scan, const Cloud& cloud);

/** How many of a cloud's points, the first ones, the scan's own lidar measured. */
[[nodiscard]] std::size_t ownPoints(const Scan& scan, const Cloud& cloud);
}  // namespace dyslam
