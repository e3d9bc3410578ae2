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
  std::size_t begin = 0;  //!< its first point; it has those up to the next part's
  std::size_t lidar = 1;  //!< number of the lidar, the same in all scans; 0 is the scan's own
  double stamp = 0;       //!< of its own scan, after Scan::stamp [s]
  Pose T_scan_lidar = Pose::Identity();  //!< takes points from its lidar's frame to the scan's
  std::string sensor_label;              //!< of its lidar
};

/** One revolution (or one shot) of a 3D LiDAR, exactly as recorded.
 *
 * Every point of the input is kept in its order, invalid ones (NaN, infinite, (0,0,0)) too, so that
 * per-point outputs can be matched to the recording. The arrays beside `points` are empty when the
 * recording lacks them, else as long as `points`.
 *
 * Of a vehicle with several lidars the points of the further ones follow those of the first, in its
 * frame, as `parts`.
 */
struct Scan
{
  double stamp = 0;                     //!< UNIX time [s] that `time` counts from
  std::vector<Eigen::Vector3f> points;  //!< lidar frame [m]
  std::vector<float> intensity;         //!< reflectivity in [0, 1]
  std::vector<float> time;              //!< seconds after `stamp` (may be negative)
  std::vector<std::uint16_t> ring;      //!< laser number, 0 = lowest; of further lidars others
  Pose T_vehicle_lidar = Pose::Identity();
  std::string sensor_label;
  std::vector<ScanPart> parts;  //!< of further lidars, by first point; those before are its own

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

  /** When each point was measured, from the frame's stamp, in units of the time that `T_sweep`
   * takes; empty where that is not known. With both, the deskewing can be redone. */
  std::vector<float> phase;
  double phase_unit = 0;            //!< that time [s]; 0: one revolution of unknown duration
  Pose T_sweep = Pose::Identity();  //!< motion that the points were deskewed with

  [[nodiscard]] std::size_t size() const { return points.size(); }
};
}  // namespace dyslam
