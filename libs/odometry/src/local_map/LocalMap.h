// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/odometry/RefineOptions.h>

#include <future>

#include "ScanSample.h"
#include "SurfacePyramid.h"
#include "scans/FirstScan.h"

namespace dyslam
{
class StateArchive;

/** Surfaces around the vehicle, of the scans since the map was started. The map's resolution is
 * that of the sensor of its first scan.
 *
 * Scans are added in a thread beside the caller, for which every function waits. Not thread-safe.
 */
class LocalMap
{
 public:
  /** \param pool with one thread scans are added in the caller's */
  LocalMap(const RefineOptions& options, ThreadPool& pool);
  LocalMap(const LocalMap&) = delete;
  LocalMap& operator=(const LocalMap&) = delete;

  /** Starts the map anew.
   * \param points of the scan; added as they are deskewed */
  void restart(const Scan& scan, ScanSample points, const Pose& T_odom_vehicle);
  /** Adds a scan, and drops cells out of refine.map_radius.
   * \param T_sweep motion since the scan before, which deskews the points */
  void add(ScanSample points, const Pose& T_sweep, const Pose& T_odom_vehicle);
  /** Deskews the only scan of the map anew.
   * \param T_sweep motion in `dt` seconds */
  void deskewFirst(const Pose& T_sweep, double dt);
  /** The sample that was added last, whose memory the next one can use. */
  [[nodiscard]] ScanSample takeMemory();

  [[nodiscard]] const SurfacePyramid& surfaces() const;
  /** Surfaces of no points, with the same resolution. */
  [[nodiscard]] SurfacePyramid emptySurfaces() const;
  /** Empty unless the map has one scan. */
  [[nodiscard]] const FirstScan& first() const { return first_; }
  /** Scans in the map since it was started. */
  [[nodiscard]] int scans() const;
  /** Angle between neighbouring rings of the sensor [rad]; 0 if it has none. */
  [[nodiscard]] double ringSpacing() const { return ring_spacing_; }
  /** Side of the smallest cells [m]. */
  [[nodiscard]] double cellSize() const { return cell_size_; }
  void exchangeState(StateArchive& archive);

 private:
  void setResolution(const Scan& scan);
  /** Adds `points_`, as they are deskewed. */
  void addPoints(const Pose& T_odom_vehicle);
  /** Waits until the points of the last add() are in the map. */
  void wait() const;

  RefineOptions options_;
  ThreadPool& pool_;
  SurfacePyramid surfaces_;
  FirstScan first_;
  Eigen::Vector3d cropped_at_ = Eigen::Vector3d::Zero();  //!< odometry frame [m]
  double ring_spacing_ = 0;                               //!< [rad]
  double cell_size_ = 0;                                  //!< [m]
  int levels_ = 1;
  int scans_ = 0;
  ScanSample points_;  //!< sample of the scan that was added last

  mutable std::future<void> adding_;  //!< last member: its thread uses the others
};
}  // namespace dyslam
