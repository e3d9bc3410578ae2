// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Points of one scan as measured, before deskewing. */
struct RawPoints
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame at the moment of measurement [m]
  std::vector<float> phase;             //!< as Cloud::phase; empty: no deskewing
  std::vector<float> weight;            //!< weights in [0, 1]; empty: 1
  double phase_unit = 0;                //!< as Cloud::phase_unit
  /** Lidar that measured each point, as index of lidarRanges(); empty if there is only one. */
  std::vector<std::uint8_t> lidar;

  [[nodiscard]] std::size_t size() const { return points.size(); }
  void clear();
  /** All points in the vehicle frame at the stamp, for a vehicle motion `T_sweep`. */
  void deskewed(const Pose& T_sweep, ThreadPool& pool, std::vector<Eigen::Vector3f>& result) const;
  /** Converts the phases to units of `unit` seconds, unless their unit is a revolution. */
  void rescalePhase(double unit);
};

/** Points of a frame, thinned for the map and thinned further for the registration. */
struct ScanSample
{
  RawPoints scan;                                //!< points thinned along the rings
  std::vector<std::uint32_t> source;             //!< index of each point of `scan` in the cloud
  std::vector<Eigen::Vector3f> deskewed;         //!< `scan`, deskewed as the cloud
  RawPoints sample;                              //!< points that are registered
  std::vector<Eigen::Vector3f> sample_deskewed;  //!< `sample`, deskewed as the cloud

  /** Takes points of the frame's cloud that are at least `spacing` [m] apart along their ring, and
   * undoes their deskewing. */
  void ingest(const Frame& frame, double spacing, ThreadPool& pool);
  /** Sets the weights of `scan` to the present ones of the frame; points may have been inserted
   * into its cloud since ingest(), in the order of the scan. */
  void updateWeights(const Frame& frame);
  /** Fills `sample`: one point per cube of side `size` [m], evenly thinned if these are more than
   * `max_points`. */
  void draw(double size, std::size_t max_points);

 private:
  /** Sets `source` to points of the cloud that are at least `spacing` [m] apart along their ring.
   */
  void selectAlongRings(const Frame& frame, double spacing);
  /** Sets the lidars of the points in `source`. */
  void assignLidars(const Frame& frame);

  std::vector<Eigen::Vector3f> last_of_ring_;  //!< last selected point of each ring
  std::vector<std::uint32_t> scan_index_;      //!< Cloud::source of the points of `scan`
};
}  // namespace dyslam
