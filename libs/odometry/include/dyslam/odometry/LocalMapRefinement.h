// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace dyslam
{
enum class RefineMethod
{
  none,            //!< the guess is taken as it is; no map is kept
  point_to_plane,  //!< distance to the plane of the map's nearest surface element
  gicp             //!< distribution to distribution
};

/** Ini section `[refine]`. */
struct RefineOptions : Options
{
  RefineMethod method = RefineMethod::point_to_plane;
  double cell_size = 0.4;             //!< of the map; surfaces are read from three cells across [m]
  double cell_points = 200;           //!< a cell with this many points takes no more
  double map_spacing = 0.1;           //!< nearer followers along a ring are left out [m]
  double map_radius = 100;            //!< farther cells are dropped [m]
  double sample_size = 0.8;           //!< registered points: one per cube of this side [m]
  int max_points = 10000;             //!< cap on registered points per scan
  int max_iterations = 25;            //!< per level of the map
  double kernel = 0.06;               //!< scale of the robust kernel once the guess is good [m]
  double max_kernel = 0.6;            //!< its start where guesses have been bad [m]
  double start_deviation = 2;         //!< how wrong the guess of the first motion may be [m]
  double guess_sigma = 0.3;           //!< how far guesses are trusted [m]
  double guess_sigma_angle = 0.0349;  //!< ... and rotation [rad]
  double odometry_trust = 0;          //!< share of the odometry's own information that joins it
  /** Residuals of neighbouring points err together: that many count as one measurement. Tunnels
   * and open fields, where the guess must hold against the pattern of the samples, ask for this
   * many; on KITTI drive 0005 the normalised squared error is 0.9 with it, where 6 is exact. */
  double correlated_points = 22;
  /** Level ground tells height, roll and pitch; of the way ahead and the heading it tells nothing
   * but what its errors make up. Where nearly all that is seen is road, that is more than walls and
   * posts can mend: level surfaces together count at most so many times as much as all others, but
   * never less than a fifth: in an open field there is nothing else. */
  double level_share = 12;
  double min_inlier_share = 0.2;  //!< with less agreement the registration has failed

  void describe(OptionsVisitor& visitor) override;
};

struct RefineResult
{
  Pose T_odom_vehicle = Pose::Identity();
  /** Motion since the frame before. Its information is that of the registration, of
   * r = log(T_measured^-1 T), plus the little that the guess gives: it stays small, but positive,
   * along directions that the scene leaves open. */
  MotionEstimate motion;
  /** Of the registration, and of a guess that came with a prior of another pose. */
  Matrix6 measured_information = Matrix6::Zero();
  /** Below 1 where the points insisted on more than the prior allows. */
  Vector6 prior_weight = Vector6::Ones();
  /** The scene fixes some direction of motion less well than guess_sigma does. */
  bool degenerate = false;
  double inlier_share = 0;    //!< of the registered points, those that agree with the map
  double kernel = 0;          //!< scale of the robust kernel at the start [m]
  std::size_t points = 0;     //!< registered
  std::size_t map_cells = 0;  //!< after the frame joined
};

/** What is known of a pose before the scan is looked at. */
struct PosePrior
{
  Pose T_odom_vehicle = Pose::Identity();
  Matrix6 information = Matrix6::Zero();  //!< of log(T_prior^-1 T) [1/m^2, 1/rad^2]

  /** Take in an independent measurement of the same pose. */
  void join(const Pose& T_measured, const Matrix6& measured);
  /** Standard deviations (Mahalanobis) to a measurement with its own [m] and [rad]. \pre
   * `information` is positive definite. */
  [[nodiscard]] double deviationsTo(const Pose& T_measured, double deviation, double turn) const;
};

/** Registration of each scan to a local map that it then joins: scan to map odometry.
 *
 * Points are weighted by static_confidence and 1 - moving_probability where the frame has them. Not
 * thread-safe. Same bytes for any number of threads.
 */
class LocalMapRefinement
{
 public:
  /** \throws UserError for options out of range. The pool must outlive the object. */
  LocalMapRefinement(const RefineOptions& options, ThreadPool& pool);
  ~LocalMapRefinement();
  LocalMapRefinement(LocalMapRefinement&&) noexcept;

  /** Register Frame::cloud, starting from a guess of the pose, and add it to the map.
   *
   * A deskewed cloud (Cloud::phase) is deskewed anew with the motion found, while it is found; the
   * frame's own cloud stays as it is. The first frame only starts the map, at the guess; the second
   * also mends the deskewing of the first. On trouble the guess is kept, motion.converged is false
   * with a reason and the map stays as it is; after five such frames with points the map is begun
   * anew. \param prior joins the points in finding the pose, with heavy tails. A guess
   * that differs from it is taken for a measurement of its own, trusted as guess_sigma says;
   * without a prior the guess alone is trusted that far. */
  RefineResult refine(const Frame& frame,
                      const Pose& T_odom_vehicle_guess,
                      const PosePrior* prior = nullptr);

  /** How wrong the guess of the next registration may be if it is the first to its map, in place of
   * the option's [m]. Maps begun anew later go by the option again. */
  void setStartDeviation(double deviation);

  /** Pose after the last frame. */
  [[nodiscard]] const Pose& pose() const;
  /** Mean points of the map's cells, odom frame [m]; in a fixed order. */
  [[nodiscard]] std::vector<Eigen::Vector3f> mapPoints() const;
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
