// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>

namespace dyslam
{
/** Options of tracked objects in the factor graph. */
struct ObjectGraphOptions : Options
{
  /** Least number of observations for the estimate of a speed. */
  static constexpr int min_for_speed = 4;

  double max_range = 80;     //!< largest range of observations that are used [m]
  int min_observations = 5;  //!< least number before an object is added to the graph
  double max_gap = 1;        //!< largest time between observations linked by a motion factor [s]
  double max_jump = 3;  //!< largest distance from the predicted position for a motion factor [m]

  // Static or dynamic
  double moving_speed = 0.6;     //!< an object that was ever significantly faster is dynamic [m/s]
  double speed_window = 1;       //!< time window of the speed, at least four successive scans [s]
  double max_static_motion = 1;  //!< an object displaced by more within its sighting is dynamic [m]
  double min_static_time = 1;    //!< observed at one place for so long, an object is static [s]

  // Noise. Errors of successive observations of one object are correlated; larger sigmas account
  // for it.
  double static_sigma_scale = 3;  //!< factor on the sigmas of observations of static objects
  int static_saturation = 50;     //!< keyframes after which further observations add no information
  double moving_sigma_scale = 3;  //!< factor on the sigmas of observations of moving objects
  double tilt_sigma = 11.5 * radians_per_degree;  //!< sigma of an object's roll and pitch [rad]
  double acceleration_sigma = 9;  //!< sigma of a moving object's acceleration [m/s^2]
  /** Sigma of its angular acceleration [rad/s^2]. */
  double angular_acceleration_sigma = 172 * radians_per_degree;
  double motion_sigma = 0.3;  //!< sigma of a motion about the velocity, in one time step [m/s]
  /** Sigma of a rotation about the angular velocity [rad/s]. */
  double angular_motion_sigma = 17.2 * radians_per_degree;

  double window = 2;  //!< poses of moving objects older than this are held fixed [s]
  /** Ego poses older than this are held fixed; 0: nothing is optimised until a loop or the end. */
  int window_keyframes = 10;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
