// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Places around the lidars where their own vehicle may be seen: roof, mast, or a person carrying
 * them.
 *
 * While the vehicle moves, its own returns stay in place in the lidar's frame, whereas the
 * surroundings pass by. A place (a cube of 0.1 m and its neighbours) is free if the lidar had
 * returns there in few of the last 20 scans, which are at least 0.3 m or 10 degrees apart. Until
 * there are eight of these scans (before the vehicle moves), it may be everywhere.
 *
 * After the first 20 of these scans the vehicle only grows where it touches what it had in the last
 * 60: whoever then moves along with it at a constant distance is not part of it.
 */
class OwnVehicle
{
 public:
  /** \param range largest distance of observed places from each lidar [m] */
  explicit OwnVehicle(double range);

  /** Adds a scan, if the vehicle has moved enough since the last scan that was added. */
  void observe(const Scan& scan);
  /** To be called for each scan, with the motion since the previous scan. */
  void addMotion(const Pose& T_previous_current);
  /** \param point lidar's frame, not deskewed [m] \param lidar ScanPart::lidar; 0: the first one
   * \return false if the place is free or out of range */
  [[nodiscard]] bool mayBeAt(const Eigen::Vector3f& point, std::size_t lidar = 0) const;
  void exchangeState(StateArchive& archive);

 private:
  /** Places around one lidar. */
  struct Places
  {
    std::deque<std::vector<std::uint32_t>> observations;  //!< per scan: cells with returns
    std::vector<bool> may_be;                             //!< per cell; empty: everywhere
    std::size_t observed = 0;                             //!< scans so far
    /** Per cell: number of scans for which it still counts as the vehicle's. */
    std::vector<std::uint8_t> known;
  };

  [[nodiscard]] std::size_t cellOf(const Eigen::Vector3f& point) const;
  void observe(const std::vector<Eigen::Vector3f>& points, Places& places) const;
  void decide(Places& places) const;
  /** Cells with returns in many of the last scans. */
  [[nodiscard]] std::vector<std::uint32_t> constantCells(const Places& places) const;
  /** The cell and its neighbours, of which it is the middle one. */
  [[nodiscard]] std::array<std::size_t, 27> cellsAround(std::uint32_t cell) const;
  /** Those of the cells that are known, or connected with known ones by others of them. */
  [[nodiscard]] std::vector<std::uint32_t> connectedWithKnown(
      const std::vector<std::uint32_t>& cells, const Places& places) const;

  float range_;
  std::size_t side_;                            //!< side of the grid [cells]
  Pose T_observed_current_ = Pose::Identity();  //!< motion since the last added scan
  bool any_observed_ = false;
  std::vector<Places> lidars_;  //!< by number of the lidar
};
}  // namespace dyslam
