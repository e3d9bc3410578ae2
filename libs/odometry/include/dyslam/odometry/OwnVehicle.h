// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Where around the lidars their own vehicle may be seen: roof, mast, or who carries them.
 *
 * The vehicle's returns stay where they are in the lidar's frame while it drives, those of the
 * surroundings pass by. A place (a cube of 0.1 m, and those around it) is free if the lidar had no
 * returns there in most of the last scans that were taken 0.3 m or 10 degrees apart. Until eight of
 * those are known, as before the vehicle moves, it may be everywhere.
 */
class OwnVehicle
{
 public:
  /** \param range of the places that are observed, from each lidar [m] */
  explicit OwnVehicle(double range);

  /** Adds a scan, if the vehicle has moved on since the last that was added. */
  void observe(const Scan& scan);
  /** The motion since the scan before; for each scan. */
  void addMotion(const Pose& T_previous_current);
  /** \param point of a lidar's frame, not deskewed \param lidar ScanPart::lidar; 0: the first one
   * \return false if it is free or out of range */
  [[nodiscard]] bool mayBeAt(const Eigen::Vector3f& point, std::size_t lidar = 0) const;
  void exchangeState(StateArchive& archive);

 private:
  /** Around one lidar. */
  struct Places
  {
    std::deque<std::vector<std::uint32_t>> observations;  //!< cells with returns, of each scan
    std::vector<bool> may_be;                             //!< of each cell; empty: everywhere
  };

  [[nodiscard]] std::size_t cellOf(const Eigen::Vector3f& point) const;
  void observe(const std::vector<Eigen::Vector3f>& points, Places& places) const;
  void decide(Places& places) const;

  float range_;
  std::size_t side_;                            //!< of the grid [cells]
  Pose T_observed_current_ = Pose::Identity();  //!< since the last scan that was added
  bool any_observed_ = false;
  std::vector<Places> lidars_;  //!< by number
};
}  // namespace dyslam
