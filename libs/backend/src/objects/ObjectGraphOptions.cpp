// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/ObjectGraphOptions.h>

namespace dyslam
{
void ObjectGraphOptions::describe(OptionsVisitor& v)
{
  v.real("max_range", max_range, 0, 1000,
         "largest range of object observations that are added to the graph [m]");
  v.integer("min_observations", min_observations, min_for_speed, 10000,
            "least number of observations of an object before it is added to the graph");
  v.real("max_gap", max_gap, 0, 100,
         "largest time between two observations that a motion factor links [s]");
  v.real(
      "max_jump", max_jump, 0, 1000,
      "largest distance of an object from its predicted position that a motion factor allows [m]");
  v.real("moving_speed", moving_speed, 0, 100,
         "speed above which an object is dynamic, if exceeded significantly [m/s]");
  v.real("speed_window", speed_window, 0.1, 100, "time window of an object's speed estimate [s]");
  v.real("max_static_motion", max_static_motion, 0, 1000,
         "displacement beyond which an object is dynamic, in addition to the odometry's drift [m]");
  v.real("min_static_time", min_static_time, 0, 1000,
         "least time that an object is observed at one place before it is static [s]");
  v.real("static_sigma_scale", static_sigma_scale, 0.1, 100,
         "factor on the sigmas of observations of static objects, whose errors are correlated");
  v.integer("static_saturation", static_saturation, 1, 1000000,
            "keyframes after which further observations of a static object add no information");
  v.real("moving_sigma_scale", moving_sigma_scale, 0.1, 100,
         "factor on the sigmas of observations of moving objects, whose errors are correlated");
  v.degrees("tilt_sigma_deg", tilt_sigma, 0.01, 90, "sigma of an object's roll and pitch [deg]");
  v.real("acceleration_sigma", acceleration_sigma, 1e-3, 1000,
         "sigma of a moving object's acceleration [m/s^2]");
  v.degrees("angular_acceleration_sigma_deg_s2", angular_acceleration_sigma, 0.1, 10000,
            "sigma of a moving object's angular acceleration [deg/s^2]");
  v.real("motion_sigma", motion_sigma, 1e-4, 100,
         "sigma of a moving object's motion about its velocity within one time step [m/s]");
  v.degrees("angular_motion_sigma_deg_s", angular_motion_sigma, 0.01, 10000,
            "sigma of a moving object's rotation about its angular velocity within one time step "
            "[deg/s]");
  v.renamed("angular_acceleration_sigma_deg", "angular_acceleration_sigma_deg_s2");
  v.renamed("angular_motion_sigma_deg", "angular_motion_sigma_deg_s");
  v.real("window", window, 0, 1e6, "age above which poses of moving objects are held fixed [s]");
  v.integer("window_keyframes", window_keyframes, 0, 1000000,
            "newest ego poses optimised with the objects; 0: nothing is optimised until a loop or "
            "the end");
}
}  // namespace dyslam
