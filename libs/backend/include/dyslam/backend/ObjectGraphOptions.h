// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
/** How tracked objects enter the factor graph. */
struct ObjectGraphOptions : Options
{
  double max_range = 80;     //!< of observations that are used [m]
  int min_observations = 5;  //!< before an object is added to the graph
  double max_gap = 1;        //!< largest gap between observations linked by a motion [s]
  double max_jump = 3;       //!< largest distance from the predicted position [m]

  // Static or dynamic
  double moving_speed = 0.6;     //!< an object that was ever significantly faster is dynamic [m/s]
  double speed_window = 1;       //!< over which speeds are estimated [s]
  double max_static_motion = 1;  //!< ... or was displaced by more within its sighting [m]
  double min_static_time = 1;    //!< observed at one place for so long, an object is static [s]

  // Noise. Errors of successive observations of one object are correlated; larger sigmas account
  // for it.
  double static_sigma_scale = 3;
  int static_saturation = 50;  //!< keyframes after which more of them add no information
  double moving_sigma_scale = 3;
  double tilt_sigma = 0.2;                //!< of an object's roll and pitch [rad]
  double acceleration_sigma = 9;          //!< of a moving object [m/s^2]
  double angular_acceleration_sigma = 3;  //!< about the vertical axis [rad/s^2]
  double motion_sigma = 0.3;              //!< of its velocity within one time step [m/s] ...
  double angular_motion_sigma = 0.3;      //!< [rad/s]

  double window = 2;  //!< poses of moving objects older than this are held fixed [s]
  /** Older ego poses are held fixed; 0: nothing is optimised until a loop or the end. */
  int window_keyframes = 10;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
