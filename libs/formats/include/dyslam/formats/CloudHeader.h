// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** Type of the numbers of a field. */
enum class CloudFieldType
{
  float32,
  float64,
  uint8
};

/** A field of each point. */
struct CloudHeaderField
{
  std::string name;
  CloudFieldType type = CloudFieldType::float32;
};

/** What a binary cloud file says before its points, which follow one after the other, little-endian
 * and without padding. */
struct CloudHeader
{
  std::vector<CloudHeaderField> fields;
  std::uint64_t points = 0;
  /** The length of the header is that with any other number of points, so that it can be written
   * again when the number is known. */
  bool has_fixed_length = false;
  std::string comment;                                  //!< of a PLY
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();  //!< of a PCD: position of the sensor [m]
};

/** PCD 0.7. */
[[nodiscard]] std::string pcdHeader(const CloudHeader& header);
/** PLY 1.0. */
[[nodiscard]] std::string plyHeader(const CloudHeader& header);
}  // namespace dyslam
