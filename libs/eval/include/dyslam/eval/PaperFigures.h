// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Results of one method on one sequence in the paper; missing ones are empty. */
struct PaperRow
{
  std::string method;
  std::optional<double> t_rel_percent;          // Table 1
  std::optional<double> r_rel_deg_per_100m;     // Table 1
  std::optional<double> rpe_translation_rmse;   // Table 2 [m]
  std::optional<double> ate_translation_rmse;   // Tables 6, 7 [m]
  std::optional<double> ate_rotation_rmse_deg;  // Table 6, there in radians
};

/** Rows of Tables 1, 2, 6 and 7 of Gao et al., "An enhanced LiDAR SLAM based on 3D moving object
 * tracking in dynamic scene", by sequence: "odometry/04", "tracking/04", "campus/01".
 * \throws UserError for a sequence not in the paper, naming the nearest one. */
[[nodiscard]] std::vector<PaperRow> paperFigures(const std::string& sequence);

/** Means of Table 1 over KITTI odometry 00 to 10. \param method name in the paper: "DyLO", "LOAM
 * w/o mapping" \return nothing for a method that is not in the table */
[[nodiscard]] std::optional<PaperRow> paperMeanDrift(const std::string& method);

/** A row of Table 3. */
struct PaperTimes
{
  std::string method;
  std::optional<double> preprocess_ms;
  double pose_estimation_ms = 0;
  double overall_ms = 0;
};
[[nodiscard]] std::vector<PaperTimes> paperTimes();
}  // namespace dyslam
