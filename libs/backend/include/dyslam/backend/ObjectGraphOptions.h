// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>

namespace dyslam
{
/** How tracked objects enter the factor graph. */
struct ObjectGraphOptions : Options
{
  double max_range = 80;     //!< of observations that are used [m]
  int min_observations = 5;  //!< before an object enters the graph
  double max_gap = 1;        //!< between successive observations that a motion joins [s]
  double max_jump = 3;       //!< from where its motion takes an object; beyond, it starts anew [m]

  // Standing or moving
  double moving_speed = 0.6;       //!< an object that was ever significantly faster moves [m/s]
  double speed_window = 1;         //!< over which speeds are estimated [s]
  double max_standing_motion = 1;  //!< ... or came farther than this within its sighting [m]
  double min_standing_time = 1;    //!< seen at one place for so long, an object stands [s]

  // Noise. Errors of successive observations of one object are alike; larger sigmas account for it.
  double standing_sigma_scale = 3;
  int standing_saturation = 50;  //!< keyframes after which more of them add no information
  double moving_sigma_scale = 3;
  double tilt_sigma = 0.2;                //!< of an object's roll and pitch [rad]
  double acceleration_sigma = 9;          //!< of a moving object [m/s^2]
  double angular_acceleration_sigma = 3;  //!< about the vertical axis [rad/s^2]
  double motion_sigma = 0.3;              //!< of its velocity within one time step [m/s] ...
  double angular_motion_sigma = 0.3;      //!< [rad/s]

  double window = 2;  //!< poses of moving objects older than this are held [s]
  /** Ego poses before these are held; 0: nothing is optimised until a loop or the end. */
  int window_keyframes = 10;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
