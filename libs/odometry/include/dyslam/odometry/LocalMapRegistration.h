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
  double cell_size = 0.4;  //!< of the map; surfaces are read from three cells across [m]
  /** Of the map: each has cells twice as large. A surface is read from the smallest cells that hold
   * one, so that rings far apart have surfaces, too. 0: as the sensor's first scan asks for. */
  int levels = 0;
  /** Where things are rough, the points of a single ring form a ribbon along the rays, which moves
   * with the sensor. With several levels, surfaces at an angle to the ray of fewer ring spacings
   * than this are left out. */
  double min_incidence = 4;
  double max_points_per_cell = 200;  //!< a cell with this many points takes no more
  double map_spacing = 0.1;          //!< nearer followers along a ring are left out [m]
  double map_radius = 100;           //!< farther cells are dropped [m]
  double sample_size = 0.8;          //!< registered points: one per cube of this side [m]
  double sparse_sample_size = 0.4;   //!< the same where the map has several levels [m]
  int max_points = 10000;            //!< cap on registered points per scan
  int max_iterations = 25;           //!< per level of the map
  double loss_width = 0.06;          //!< of the robust loss once the initial guess is good [m]
  double max_loss_width = 0.6;       //!< its start where initial guesses have been bad [m]
  double initial_sigma = 2;  //!< of the initial guess of the first registration to a map [m]
  double guess_sigma = 0.3;  //!< of an initial guess that is not the prior [m]
  double guess_sigma_angle = 0.0349;      //!< ... and of its rotation [rad]
  double odometry_information_scale = 0;  //!< of the matcher's information, added to the guess's
  /** Residuals of neighbouring points are correlated: this many count as one measurement. Tunnels
   * and open fields, where the prior must hold against the pattern of the samples, need this many;
   * on KITTI drive 0005 the normalised squared error is 0.9 with it, where 6 is exact. */
  double points_per_measurement = 22;
  /** Ground surfaces constrain height, roll and pitch; along the road and in heading they add only
   * their errors. Where nearly all that is seen is road, that outweighs walls and posts: ground
   * surfaces together get at most this many times the weight of all others, but never less than a
   * fifth of their own, for in an open field there is nothing else. */
  double max_ground_weight_ratio = 12;
  /** Share of the points that have a surface in the map: less, and the map's cells are too small
   * for the sensor's rings, which then move along with it. */
  double min_surface_share = 0.14;
  /** Inliers, by their robust weight, among the points that have a surface in the map; below, the
   * registration has failed. How many points have one depends on the sensor. */
  double min_inlier_ratio = 0.3;

  void describe(OptionsVisitor& visitor) override;
};

struct RegistrationResult
{
  Pose T_odom_vehicle = Pose::Identity();
  /** Motion since the previous frame. Its information is that of the registration, of
   * r = log(T_measured^-1 T), plus that of the prior and the guess: it stays small, but positive,
   * along directions that the scene leaves open. */
  MotionEstimate motion;
  /** Of the registration, and of a guess that came with a prior of another pose. */
  Matrix6 measured_information = Matrix6::Zero();
  /** Robust weight of the prior per component: below 1 where the points contradict it. */
  Vector6 prior_weight = Vector6::Ones();
  /** The scene fixes some direction of motion less well than guess_sigma does. */
  bool degenerate = false;
  double inlier_share = 0;    //!< weight of the registered points that agree with the map, of all
  double surface_share = 0;   //!< weight of the points that have a surface in the map, of all
  double inlier_ratio = 0;    //!< weight of those that agree with it, of that of those
  double loss_width = 0;      //!< of the robust loss at the start [m]
  std::size_t points = 0;     //!< registered
  std::size_t map_cells = 0;  //!< before the frame is integrated
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
   * A cloud with phases is deskewed anew with the motion found, while it is found; the frame's own
   * cloud stays as it is. The first frame gets the guess; the second also corrects the deskewing of
   * the first. On trouble the guess is kept and motion.converged is false with a reason.
   * \param prior of the motion since the previous frame; it is fused with the points, with heavy
   *   tails. A guess that differs from it is taken for a measurement of its own with the standard
   *   deviation guess_sigma; without a prior the guess is one with that standard deviation.
   * \param initial_sigma replaces the option's if this is the first registration to its map [m] */
  [[nodiscard]] RegistrationResult registerFrame(const Frame& frame,
                                                 const Pose& T_odom_vehicle_guess,
                                                 const MotionPrior* prior = nullptr,
                                                 std::optional<double> initial_sigma = {});

  /** What registerFrame() would give; nothing changes. */
  [[nodiscard]] RegistrationResult tryFrame(const Frame& frame,
                                            const Pose& T_odom_vehicle_guess,
                                            const MotionPrior* prior = nullptr);

  /** Add the frame registered last to the map, at the pose found and with the weights that it has
   * now. A frame that failed is left out; after five such frames in a row that had points, the map
   * is restarted from the last one. */
  void integrate(const Frame& frame);

  /** Frames in the map since it was started; 0 with method none. */
  [[nodiscard]] int framesInMap() const;
  /** Pose after the last frame. */
  [[nodiscard]] const Pose& pose() const;
  /** Mean points of the map's cells, odom frame [m]; in a fixed order. */
  [[nodiscard]] std::vector<Eigen::Vector3f> mapPoints() const;
  void reset();
  /** What is kept between one frame's integrate() and the next registerFrame(). */
  void exchangeState(StateArchive& archive);

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
