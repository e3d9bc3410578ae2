// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Parallel.h>

#include <cstddef>
#include <functional>

namespace dyslam
{
/** Normal equations of scalar residuals r = n . (T p - q), about log(T^-1 T'). */
struct RowSums
{
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double error = 0;   //!< weighted sum of squares [m^2]
  double weight = 0;  //!< sum of the robust weights
  std::size_t inliers = 0;

  /** \param n unit direction in the reference frame \param p point in the moving frame
   *  \param R rotation of T \param w weight, the kernel's included */
  void addRow(const Eigen::Vector3d& n,
              const Eigen::Vector3d& p,
              const Eigen::Matrix3d& R,
              double r,
              double w);
  void add(const RowSums& other);
};

struct RowAlignmentSettings
{
  int max_iterations = 30;
  double start_kernel = 1;  //!< matches are gated at that distance at first [m]
  double kernel = 0.2;      //!< and at that one in the end [m]
  double correlated_points = 50;
  std::size_t fewest_inliers = 30;
};

/** Adds the rows of the points [begin, end) at pose T, those nearer than `gate`. */
using RowMatcher = std::function<void(
    std::size_t begin, std::size_t end, const Pose& T, double gate, RowSums& sums)>;

/** Gauss-Newton over rows that are matched anew in each iteration. */
[[nodiscard]] MotionEstimate alignByRows(std::size_t count,
                                         const RowMatcher& match,
                                         const Pose& T_guess,
                                         const RowAlignmentSettings& settings,
                                         ThreadPool& pool);

/** Geman-McClure weight of a residual. */
[[nodiscard]] inline double robustWeight(double r2, double scale)
{
  const double k2 = scale * scale;
  const double g = k2 / (k2 + r2);
  return g * g;
}
}  // namespace dyslam
