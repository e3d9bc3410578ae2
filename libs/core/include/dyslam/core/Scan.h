// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** A scan of a further lidar of the vehicle, as part of a Scan. */
struct ScanPart
{
  std::size_t begin = 0;  //!< index of its first point; its points end where the next part begins
  std::size_t lidar = 1;  //!< number of the lidar, the same in all scans; 0 is the first lidar
  double stamp = 0;       //!< stamp of its lidar's scan, relative to Scan::stamp [s]
  Pose T_scan_lidar = Pose::Identity();  //!< from its lidar's frame to the first lidar's
  std::string sensor_label;              //!< sensor label of its lidar
};

/** One revolution (or one shot) of a 3D LiDAR, exactly as recorded.
 *
 * Every point of the input is kept in its order, invalid ones (NaN, infinite, (0,0,0)) too, so that
 * per-point outputs can be matched to the recording. The arrays beside `points` are empty when the
 * recording lacks them, else as long as `points`.
 *
 * With several lidars, the points of the further lidars follow those of the first one, in the frame
 * of the first one, as `parts`.
 */
struct Scan
{
  /** UNIX time [s] that `time` counts from; for scans with times at their beginning or middle, as
   * deskewing to their end is unstable. */
  double stamp = 0;
  std::vector<Eigen::Vector3f> points;  //!< lidar frame [m]
  std::vector<float> intensity;         //!< reflectivity in [0, 1]
  std::vector<float> time;              //!< seconds after `stamp` (may be negative; NaN: unknown)
  std::vector<std::uint16_t> ring;  //!< laser number, 0: lowest; further lidars have other numbers
  Pose T_vehicle_lidar = Pose::Identity();
  std::string sensor_label;
  std::vector<ScanPart> parts;  //!< points of further lidars, ordered by `begin`

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

/** True for a return: all coordinates finite and not (0,0,0). */
[[nodiscard]] inline bool isReturn(const Eigen::Vector3f& p)
{
  return p.allFinite() && !p.isZero(0);
}

/** Points ready for algorithms: valid, cropped, motion-compensated, in the vehicle frame at the
 * frame's stamp. */
struct Cloud
{
  std::vector<Eigen::Vector3f> points;  //!< vehicle frame [m]
  std::vector<float> intensity;         //!< as in Scan; empty if unknown
  std::vector<std::uint32_t> source;    //!< position of each point in the Scan it came from

  /** Measurement time of each point after the frame's stamp, in units of the duration of `T_sweep`;
   * empty if unknown. With both, the deskewing can be redone. */
  std::vector<float> phase;
  double phase_unit = 0;  //!< duration of `T_sweep` [s]; 0: a revolution of unknown duration
  Pose T_sweep = Pose::Identity();  //!< vehicle motion that the points were deskewed with

  [[nodiscard]] std::size_t size() const { return points.size(); }
};
}  // namespace dyslam
