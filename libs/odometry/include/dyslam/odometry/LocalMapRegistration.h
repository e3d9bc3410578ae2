// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/Pose.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace dyslam
{
class StateArchive;

enum class RefineMethod
{
  none,            //!< no registration; no map is kept
  point_to_plane,  //!< distance to the plane of the map's nearest surface element
  gicp             //!< distribution to distribution
};

/** Ini section `[refine]`. */
struct RefineOptions : Options
{
  RefineMethod method = RefineMethod::point_to_plane;
  double cell_size = 0.4;  //!< least cell size; surfaces are computed from 3 x 3 x 3 cells [m]
  /** Levels of the map, each with cells twice as large. A surface is taken from the smallest cells
   * that have one, so that rings far apart have surfaces, too. 0: by the ring spacing of the first
   * scan. */
  int levels = 0;
  /** On rough objects the points of a single ring form a ribbon along the rays, which moves with
   * the sensor. With several levels, surfaces at an angle to the ray of fewer ring spacings than
   * this are left out. */
  double min_incidence = 4;
  double max_points_per_cell = 200;  //!< upper limit of the points per cell
  double map_spacing = 0.1;  //!< least distance of successive points of a ring in the map [m]
  double map_radius = 100;   //!< distance beyond which cells are dropped [m]
  double sample_size = 0.8;  //!< side of the cubes with one registered point each [m]
  double sparse_sample_size = 0.4;  //!< sample_size for maps of several levels [m]
  int max_points = 10000;           //!< upper limit of the registered points per scan
  int max_iterations = 25;          //!< upper limit per level of the map
  double loss_width = 0.06;         //!< final width of the robust loss [m]
  double max_loss_width = 0.6;      //!< largest initial width, after bad initial guesses [m]
  double initial_sigma = 2;  //!< sigma of the initial guess at the first registration to a map [m]
  double guess_sigma = 0.3;  //!< sigma of a guess that is not the prior: translation [m]
  double guess_sigma_angle = 0.0349;  //!< sigma of such a guess: rotation [rad]
  /** Residuals of neighbouring points are correlated: this many count as one measurement. Tunnels
   * and open fields, where the prior must outweigh the sampling pattern, need this many; on KITTI
   * drive 0005 the normalised squared error is 0.9 with it, where 6 is exact. */
  double points_per_measurement = 22;
  /** Ground surfaces constrain height, roll and pitch; along the road and in heading they add only
   * errors. Where most points are on the road, they would outweigh walls and posts: the total
   * weight of ground surfaces is limited to this many times that of all others, but not below a
   * fifth of their own, since an open field has no others. */
  double max_ground_weight_ratio = 12;
  /** Share of the points that have a surface in the map: below, the map's cells are too small for
   * the sensor's rings, whose surfaces then move with the sensor. */
  double min_surface_share = 0.14;
  /** Inliers, by their robust weight, among the points that have a surface in the map; below, the
   * registration has failed. The share of points that have one depends on the sensor. */
  double min_inlier_ratio = 0.3;

  void describe(OptionsVisitor& visitor) override;
};

struct RegistrationResult
{
  Pose T_odom_vehicle = Pose::Identity();
  /** Motion since the previous frame. Its information is that of the registration, of
   * r = log(T_measured^-1 T), plus that of the prior and the guess: it is small, but positive,
   * along directions that the scene does not constrain. */
  MotionEstimate motion;
  /** Of the registration, and of a guess that came with a prior of another pose. */
  Matrix6 measured_information = Matrix6::Zero();
  /** Robust weight of the prior per component: below 1 where the points contradict it. */
  Vector6 prior_weight = Vector6::Ones();
  /** The scene constrains some direction of motion less than guess_sigma does. */
  bool degenerate = false;
  double inlier_share = 0;   //!< weight of the inliers over that of all registered points
  double surface_share = 0;  //!< weight of the points with a surface in the map over that of all
  double inlier_ratio = 0;   //!< weight of the inliers over that of the points with a surface
  double loss_width = 0;     //!< initial width of the robust loss [m]
  std::size_t points = 0;    //!< registered
};

/** Registration of each scan to a local map of surfaces (scan to map odometry).
 *
 * Points are weighted by static_confidence and 1 - moving_probability where the frame has them. Not
 * thread-safe. Same bytes for any number of threads.
 */
class LocalMapRegistration
{
 public:
  /** \throws UserError for options out of range. The pool must outlive the object. */
  LocalMapRegistration(const RefineOptions& options, ThreadPool& pool);
  ~LocalMapRegistration();
  LocalMapRegistration(LocalMapRegistration&&) noexcept;

  /** Register Frame::cloud, starting from an initial guess of the pose.
   *
   * A cloud with phases is deskewed again with the current motion in each iteration; the frame's
   * own cloud stays as it is. The first frame gets the guess; the second also corrects the
   * deskewing of the first. If the registration fails, the guess is kept and motion.status is
   * not_found, with a reason. With enough inliers the pose found is taken even if it did not
   * converge within max_iterations; motion.status is not_settled then, with a reason.
   * \param prior of the motion since the previous frame; it is fused with the points under a robust
   *   loss. A guess that differs from it counts as a separate measurement with the standard
   *   deviation guess_sigma; without a prior the guess is the prior, with that standard deviation.
   * \param initial_sigma replaces the option's if this is the first registration to its map [m] */
  [[nodiscard]] RegistrationResult registerFrame(const Frame& frame,
                                                 const Pose& T_odom_vehicle_guess,
                                                 const MotionPrior* prior = nullptr,
                                                 std::optional<double> initial_sigma = {});

  /** registerFrame() of the same frame once more, from another guess, as if it had not been
   * registered yet. Between registerFrame() and integrate() only. */
  [[nodiscard]] RegistrationResult registerAgain(const Frame& frame,
                                                 const Pose& T_odom_vehicle_guess,
                                                 const MotionPrior* prior);

  /** The result of registerFrame(), without changing the object. Between integrate() and
   * registerFrame() only. \throws std::logic_error if the map has fewer than two frames. */
  [[nodiscard]] RegistrationResult tryFrame(const Frame& frame,
                                            const Pose& T_odom_vehicle_guess,
                                            const MotionPrior* prior = nullptr);

  /** Add the frame registered last to the map, at the estimated pose and with its current weights.
   * A frame whose registration failed is left out; after five such frames in a row that had points,
   * the map is restarted from the last one. A frame that was accepted although it did not converge
   * is added. If the pool has several threads, the points are added beside the caller, until the
   * map is used next. */
  void integrate(const Frame& frame);

  /** Frames in the map since it was started; 0 with method none. */
  [[nodiscard]] int framesInMap() const;
  /** Pose after the last frame. */
  [[nodiscard]] const Pose& pose() const;
  /** Mean points of the map's cells, odometry frame [m]; in a fixed order. */
  [[nodiscard]] std::vector<Eigen::Vector3f> mapPoints() const;
  /** What is kept between one frame's integrate() and the next registerFrame(). */
  void exchangeState(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
