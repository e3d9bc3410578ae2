// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "local_map/ScanSample.h"
#include "local_map/SurfacePyramid.h"

namespace dyslam
{
class StateArchive;

/** The first scan of a local map: its motion, by which it is deskewed, is known with the second
 * scan only. Empty while the map has no scan or several. */
class FirstScan
{
 public:
  FirstScan() = default;
  FirstScan(const RawPoints& points, const Pose& T_odom_vehicle)
      : points_(points), T_odom_vehicle_(T_odom_vehicle)
  {
  }

  [[nodiscard]] std::size_t size() const { return points_.size(); }
  /** There is something to deskew. */
  [[nodiscard]] bool isSkewed() const { return !points_.phase.empty(); }
  /** The points are not used any more. */
  void clear() { points_.clear(); }
  /** The time to the second scan, in which the vehicle moves by the T_sweep of fill() [s]. */
  void setSweepDuration(double dt) { points_.rescalePhase(dt); }
  /** Replaces the content of the map by this scan, deskewed by a motion of the vehicle. */
  void fill(SurfacePyramid& map, const Pose& T_sweep, ThreadPool& pool) const;
  void exchangeState(StateArchive& archive);

 private:
  RawPoints points_;
  Pose T_odom_vehicle_ = Pose::Identity();
};
}  // namespace dyslam
