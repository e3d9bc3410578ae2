// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <optional>
#include <string>

namespace dyslam
{
/** Whether the points were measured at differing times, and so while the lidar moved. */
[[nodiscard]] bool isSwept(const Scan& scan);

/** Writes scans as `.bin` files, deskewed to their stamps along the poses of the lidar, as the
 * scans of KITTI odometry are.
 *
 * Between two scans the lidar moves with constant velocity (along a screw). Before the first and
 * behind the last pose, and where a scan is missing, it moves on as on the other side of the scan.
 */
class KittiDeskewing
{
 public:
  /** Takes the next scan. A scan is written with the call after it, when the motion behind it is
   * known. \param T_world_lidar pose at the stamp \param path of the file to write */
  void add(const Scan& scan, const Pose& T_world_lidar, const std::string& path);
  /** Writes the last scan. */
  void finish();

  /** Number of scans written as they are, because the points have no times. */
  [[nodiscard]] std::size_t withoutTimes() const { return without_times_; }

 private:
  struct Item
  {
    Scan scan;
    Pose T_world_lidar;
    std::string path;
  };
  /** Motion of the lidar from one scan to the next. */
  struct Motion
  {
    Pose T_start_end;
    double dt;  //!< [s], above 0
  };

  void writeWaiting(const std::optional<Motion>& after);

  std::optional<Item> waiting_;
  std::optional<Motion> before_;  //!< motion up to the waiting scan
  std::size_t without_times_ = 0;
};
}  // namespace dyslam
