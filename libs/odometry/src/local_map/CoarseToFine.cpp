// SPDX-License-Identifier: BSD-3-Clause
#include "CoarseToFine.h"

#include <algorithm>

namespace dyslam
{
namespace
{
/** Share of the usual inliers below which the registration is repeated coarse to fine. */
constexpr double poor_inliers = 0.7;
constexpr int repeated_coarseness = 4;  //!< of the map's cells
constexpr int max_coarseness = 8;
}  // namespace

double CoarseToFine::startLossWidth(double guess_error) const
{
  return std::clamp(guess_error, options_.loss_width, options_.max_loss_width);
}

ScanToMapResult CoarseToFine::alignFine(const AlignmentProblem& problem,
                                        const SurfacePyramid& map,
                                        const Pose& T_odom_vehicle_guess,
                                        double guess_error)
{
  ScanToMapSettings settings = problem.settings;
  settings.start_loss_width = startLossWidth(guess_error);
  return registration_.align(problem.points, problem.covariances, map, problem.T_odom_previous,
                             T_odom_vehicle_guess, settings);
}

ScanToMapResult CoarseToFine::alignFrom(int coarseness,
                                        const AlignmentProblem& problem,
                                        const SurfacePyramid& map,
                                        const Pose& T_guess)
{
  Pose T = T_guess;
  int iterations = 0;
  for (; coarseness > 1; coarseness /= 2)
  {
    const SurfacePyramid coarse = map.coarser(coarseness);
    ScanToMapSettings settings = problem.settings;
    settings.distributions = false;
    settings.start_loss_width = static_cast<double>(map.cellSize()) * coarseness;
    settings.loss_width *= coarseness;
    settings.prior_information /= static_cast<double>(coarseness * coarseness);
    const ScanToMapResult level = registration_.align(problem.points, problem.covariances, coarse,
                                                      problem.T_odom_previous, T, settings);
    T = level.T;
    iterations += level.iterations;
  }
  ScanToMapResult fine = alignFine(problem, map, T, options_.max_loss_width);
  fine.iterations += iterations;
  return fine;
}

ScanToMapResult CoarseToFine::align(const AlignmentProblem& problem,
                                    const SurfacePyramid& map,
                                    const Pose& T_odom_vehicle_guess,
                                    double guess_error,
                                    double usual_inliers)
{
  int coarseness = 1;
  while (coarseness < max_coarseness &&
         guess_error > static_cast<double>(map.cellSize()) * coarseness)
  {
    coarseness *= 2;
  }
  if (coarseness > 1)
  {
    return alignFrom(coarseness, problem, map, T_odom_vehicle_guess);
  }
  ScanToMapResult result = alignFine(problem, map, T_odom_vehicle_guess, guess_error);
  if (result.inlier_share < poor_inliers * usual_inliers)
  {
    const ScanToMapResult second =
        alignFrom(repeated_coarseness, problem, map, T_odom_vehicle_guess);
    if (second.inlier_share > result.inlier_share)
    {
      result = second;
    }
  }
  return result;
}
}  // namespace dyslam
