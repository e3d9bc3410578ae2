// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** One revolution (or one shot) of a 3D LiDAR, exactly as recorded.
 *
 * Every point of the input is kept in its order, invalid ones (NaN, infinite, (0,0,0)) too, so that
 * per-point outputs can be matched to the recording. The arrays beside `points` are empty when the
 * recording lacks them, else as long as `points`.
 */
struct Scan
{
  double stamp = 0;                     //!< UNIX time [s] that `time` counts from
  std::vector<Eigen::Vector3f> points;  //!< lidar frame [m]
  std::vector<float> intensity;         //!< reflectivity in [0, 1]
  std::vector<float> time;              //!< seconds after `stamp` (may be negative)
  std::vector<std::uint16_t> ring;      //!< laser number, 0 = lowest
  Pose T_vehicle_lidar = Pose::Identity();
  std::string sensor_label;

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
