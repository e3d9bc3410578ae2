// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/TextFile.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <string>

namespace dyslam
{
/** Whether a matrix that was read from a file is a rotation, with a tolerance for text with few
 * digits and for float products. */
[[nodiscard]] inline bool isRotation(const Eigen::Matrix3d& R)
{
  constexpr double tolerance = 0.02;
  return (R * R.transpose()).isIdentity(tolerance) && R.determinant() > 0;
}

/** What is wrong with a position that was read from a file [m]; empty if nothing is. Squares of
 * much larger coordinates than any on the earth would overflow. */
[[nodiscard]] inline std::string positionError(const Eigen::Vector3d& position)
{
  constexpr double largest = 1e12;  // [m]
  return position.cwiseAbs().maxCoeff() > largest
             ? "the position is more than 1e12 m from the origin; coordinates are in metres"
             : "";
}

/** \throws UserError "file:line: what" for a position of the current line that cannot be in metres.
 */
inline void requirePosition(const TextFile& file, const Eigen::Vector3d& position)
{
  if (const std::string error = positionError(position); !error.empty())
  {
    file.fail(error);
  }
}
}  // namespace dyslam
