// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/core/Frame.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mrpt::system
{
class CTimeLogger;
}

namespace dyslam
{
class StateArchive;

class ScanMatcher;

/** Ini section `[odometry]`. */
struct OdometryOptions : Options
{
  static constexpr double min_start_speed = -50;  //!< lower limit of start_speed [m/s]
  static constexpr double max_start_speed = 100;  //!< upper limit of start_speed [m/s]

  std::string method = "constant_velocity";  //!< the scan matcher
  /** Forward speed at the first scan, if known; 0: not known. Among vehicles that all move alike
   * nothing else shows the speed at the start of a recording. [m/s] */
  double start_speed = 0;
  double start_speed_sigma = 3;  //!< sigma of start_speed, where that is given [m/s]

  void describe(OptionsVisitor& visitor) override;
};

/** Ini section `[fusion]`: how the motions found by segmenter, scan matcher and registration are
 * weighted against the motion filter's prior. */
struct FusionOptions : Options
{
  double segmenter_sigma = 0.1;  //!< sigma of the segmenter's ego-motion in x and y [m]
  /** Sigma of the segmenter's heading change [rad]. */
  double segmenter_sigma_rotation = 0.286 * radians_per_degree;
  double matcher_sigma = 0.1;  //!< sigma of the translation of a scan matcher's motion [m]
  /** Sigma of the rotation of a scan matcher's motion [rad]. */
  double matcher_sigma_rotation = 1.15 * radians_per_degree;
  double gate = 4;  //!< largest Mahalanobis distance to the prior of an accepted motion
  /** Sigmas and gate of a matcher that fuses the prior itself: a large correction of the prior
   * means that it has matched the traffic. */
  double informed_sigma = 0.03;                                 //!< sigma of the translation [m]
  double informed_sigma_rotation = 0.344 * radians_per_degree;  //!< sigma of the rotation [rad]
  double informed_gate = 1;
  /** First registration to a map: standard deviation of the initial guess where the segmenter, or
   * a matcher that fuses the prior, has given it [m]. */
  double segmenter_initial_sigma = 0.3;
  double matcher_initial_sigma = 0.1;
  double reliable_prior_sigma = 0.1;  //!< below, segmenters search only around the prior [m]
  double min_static_prior = 0.2;      //!< static probability below which points have zero weight

  void describe(OptionsVisitor& visitor) override;
};

/** Prepares the cloud of the frame's scan, deskewed by the vehicle's motion over `dt` seconds; see
 * Preprocessor::prepare(). */
using PrepareCloud = std::function<Cloud(const Pose& T_previous_current, double dt)>;

/** Ego-motion from scan to scan: a motion filter provides the prior, a scan matcher and the
 * registration to a local map measure the motion, and the results are fused.
 *
 * Per frame, in this order: predict(), preprocessing by others, resolveInterval(), segmentation by
 * others, estimate(), and, once it is decided what moves, integrate(). Not thread-safe; one object
 * per recording. Same bytes for any number of threads.
 */
class Odometry
{
 public:
  /** Loads [odometry], [fusion], [motion], [refine], [motion_sensors], [uncertainty] and the
   * sections of all scan matchers. \param pool must outlive the object \param times gets the times
   * of `odometry` (the matcher) and `refine` (the registration). \throws UserError for bad options.
   */
  Odometry(ConfigLoader& config, ThreadPool& pool, mrpt::system::CTimeLogger& times);
  /** The same with a scan matcher of your own in place of the one that [odometry] method names. */
  Odometry(ConfigLoader& config,
           ThreadPool& pool,
           mrpt::system::CTimeLogger& times,
           std::unique_ptr<ScanMatcher> matcher);
  ~Odometry();
  Odometry(Odometry&&) noexcept;

  /** Fills Frame::dt, sweep_duration, clock_offset, prior and T_odom_vehicle from scan.stamp, imu,
   * wheels and the motions before. */
  void predict(Frame& frame);
  /** Where the interval to the previous scan does not fit the sensor's rate: decides whether scans
   * are missing or the clock of the stamps was set, by registering the scan to the local map, and
   * corrects dt, clock_offset, prior, T_odom_vehicle and cloud. Call it for every frame, between
   * preprocessing and segmentation.
   * \param prepare is called for each motion that may have happened, and for the one that is found
   */
  void resolveInterval(Frame& frame, const PrepareCloud& prepare);
  /** Reads cloud, prior, moving_probability, segmenter_motion and static_prior; fills odometry,
   * odometry_accepted, odometry_rejection, static_confidence, motion and T_odom_vehicle. The
   * information of `motion` is calibrated and positive definite, that of `odometry` the matcher's
   * own. */
  void estimate(Frame& frame);
  /** Adds the frame of the last estimate() to the local map, weighted by its current moving
   * probabilities. Once after each estimate(). */
  void integrate(const Frame& frame);
  /** What is kept from frame to frame. Call it between integrate() and predict(). */
  void exchangeState(StateArchive& archive);

  /** The methods in use, e.g. "constant_velocity + point_to_plane". */
  [[nodiscard]] std::string name() const;
  /** Warnings about config and recording, one sentence each. */
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};
}  // namespace dyslam
