// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Points in 7 bytes each: all x, all y, all z as little-endian 16-bit numbers, then all
 * intensities as bytes. A coordinate is low + step * number. Those of ceilings are the last ones.
 */
struct PackedPoints
{
  std::size_t count = 0;
  std::size_t ceilings = 0;  //!< number of points of ceilings, see ceilingPointsIfMany()
  Eigen::Vector3d low = Eigen::Vector3d::Zero();   //!< lowest coordinates [m]
  Eigen::Vector3d step = Eigen::Vector3d::Zero();  //!< [m]; 1/65535 of the extent
  double voxel_size = 0;                           //!< side of cubes with one point [m]; 0: all
  std::string bytes;
};

/** Packs the finite points; if more than `max_points`, the first of every cube, whose side grows
 * from 5 cm until the limit is met.
 * \param intensity in [0, 1], one per point; null: zeros
 * \throws std::invalid_argument for another number of intensities, and for max_points = 0. */
[[nodiscard]] PackedPoints packPoints(const std::vector<Eigen::Vector3f>& points,
                                      const std::vector<float>* intensity,
                                      std::size_t max_points);

/** RFC 4648, with padding. */
[[nodiscard]] std::string base64(std::string_view bytes);
}  // namespace dyslam
