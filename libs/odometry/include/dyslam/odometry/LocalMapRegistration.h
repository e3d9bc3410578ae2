// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/Pose.h>
#include <dyslam/odometry/RefineOptions.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace dyslam
{
class StateArchive;

struct RegistrationResult
{
  Pose T_odom_vehicle = Pose::Identity();
  /** Motion since the previous frame. Its information is that of the registration, of
   * r = log(T_measured^-1 T), plus that of the prior and the guess: it is small, but positive,
   * along directions that the scene does not constrain. */
  MotionEstimate motion;
  /** Information of the registration, plus that of a guess that differs from the prior. */
  Matrix6 measured_information = Matrix6::Zero();
  /** Robust weight of the prior per component: below 1 where the points contradict it. */
  Vector6 prior_weight = Vector6::Ones();
  /** The scene constrains some direction of motion less than guess_sigma does. */
  bool degenerate = false;
  double inlier_share = 0;   //!< weight of the inliers over that of all registered points
  double surface_share = 0;  //!< weight of the points with a surface in the map over that of all
  double inlier_ratio = 0;   //!< weight of the inliers over that of the points with a surface
  double loss_width = 0;     //!< initial width of the robust loss [m]
  std::size_t points = 0;    //!< number of registered points
};

/** Registration of each scan to a local map of surfaces (scan to map odometry): align() finds the
 * pose of a frame in the map, from one or several initial guesses, and commit() adds the frame.
 *
 * Points are weighted by static_confidence and 1 - moving_probability where the frame has them. Not
 * thread-safe. Same bytes for any number of threads.
 */
class LocalMapRegistration
{
  struct State;
  struct Addition;

 public:
  /** A frame aligned with the map: the result, and what commit() needs. */
  class Alignment
  {
   public:
    Alignment();  //!< of no frame
    ~Alignment();
    Alignment(Alignment&&) noexcept;
    Alignment& operator=(Alignment&&) noexcept;
    [[nodiscard]] const RegistrationResult& result() const { return result_; }

   private:
    friend class LocalMapRegistration;
    RegistrationResult result_;
    std::unique_ptr<Addition> addition_;
  };

  /** \pre options.method is not none
   * \throws UserError for options out of range. The pool must outlive the object. */
  LocalMapRegistration(const RefineOptions& options, ThreadPool& pool);
  ~LocalMapRegistration();
  LocalMapRegistration(LocalMapRegistration&&) noexcept;

  /** Register Frame::cloud, starting from an initial guess of the pose. Map and pose() stay as they
   * are; only the memory of earlier points is used again.
   *
   * A cloud with phases is deskewed again with the current motion in each iteration; the frame's
   * own cloud stays as it is. The first frame gets the guess; the second also corrects the
   * deskewing of the first. If the registration fails, the guess is kept and motion.status is
   * not_found, with a reason; without usable points the information is the prior's. With enough
   * inliers the pose found is taken even if it did not converge within max_iterations;
   * motion.status is not_settled then, with a reason.
   * \param prior of the motion since the previous frame; it is fused with the points under a robust
   *   loss. A guess that differs from it counts as a separate measurement with the standard
   *   deviation guess_sigma; without a prior the guess is the prior, with that standard deviation.
   * \param initial_sigma replaces the option's if this is the first registration to its map [m] */
  [[nodiscard]] Alignment align(const Frame& frame,
                                const Pose& T_odom_vehicle_guess,
                                const MotionPrior* prior = nullptr,
                                std::optional<double> initial_sigma = {});

  /** Add the frame to the map, at the estimated pose and with its current weights.
   *
   * A frame whose registration failed is left out; after five such frames in a row that had points,
   * the map is restarted from the last one (motion.map_restarted). If the pool has several threads,
   * the points are added beside the caller, until the map is used next.
   * \param alignment of this frame, with no other committed since
   * \throws std::logic_error if it is of no frame */
  void commit(Alignment alignment, const Frame& frame);

  /** Frames in the map since it was started. */
  [[nodiscard]] int framesInMap() const;
  /** Running mean of RegistrationResult::inlier_share of the frames in the map. \pre there are two
   * or more. */
  [[nodiscard]] double usualInlierShare() const;
  /** Pose of the last frame committed; the guess, if its registration failed. */
  [[nodiscard]] const Pose& pose() const;
  /** Mean points of the map's cells, odometry frame [m]; in a fixed order. */
  [[nodiscard]] std::vector<Eigen::Vector3f> mapPoints() const;
  void exchangeState(StateArchive& archive);

 private:
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
