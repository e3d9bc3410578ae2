// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Parallel.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** Points of one scan as measured, before deskewing. */
struct RawPoints
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame at the moment of measurement [m]
  std::vector<float> phase;             //!< as Cloud::phase; empty if there is nothing to deskew
  std::vector<float> weight;            //!< in [0, 1]; empty for 1
  double phase_unit = 0;                //!< as Cloud::phase_unit
  /** Lidar that measured each point, as index of lidarRanges(); empty if there is only one. */
  std::vector<std::uint8_t> lidar;

  [[nodiscard]] std::size_t size() const { return points.size(); }
  void clear();
  /** All points in the vehicle frame at the stamp, if the vehicle moves by `T_sweep`. */
  void deskewed(const Pose& T_sweep, ThreadPool& pool, std::vector<Eigen::Vector3f>& result) const;
  /** Phases in units of `unit` seconds; nothing changes where theirs is a revolution. */
  void rescalePhase(double unit);
};

/** A frame's points, thinned for the map and thinned further for the registration. */
struct ScanSample
{
  RawPoints scan;                                //!< thinned along the rings
  std::vector<std::uint32_t> source;             //!< of `scan`: positions in the cloud of ingest()
  std::vector<Eigen::Vector3f> deskewed;         //!< `scan`, as the cloud is deskewed
  RawPoints sample;                              //!< what is registered
  std::vector<Eigen::Vector3f> sample_deskewed;  //!< `sample`, as the cloud is deskewed

  /** Takes the points of the frame's cloud that lie at least `spacing` [m] after the one before
   * along their ring, and undoes their deskewing. */
  void ingest(const Frame& frame, double spacing, ThreadPool& pool);
  /** Weights of `scan` anew, as the frame has them now; points may have been inserted into its
   * cloud since, in the order of the scan. */
  void updateWeights(const Frame& frame);
  /** Fills `sample`: one point per cube of side `size` [m], and evenly fewer where these are more
   * than `max_points`. */
  void draw(double size, std::size_t max_points);

 private:
  std::vector<Eigen::Vector3f> last_of_ring_;
  std::vector<std::uint32_t> scan_index_;  //!< of the points of `scan`, as Cloud::source
};
}  // namespace dyslam
