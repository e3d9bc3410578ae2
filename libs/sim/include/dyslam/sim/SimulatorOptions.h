// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Options.h>
#include <dyslam/sim/Sensor.h>

#include <string>

namespace dyslam::sim
{
enum class WorldKind
{
  urban,
  campus,
  highway,
  tunnel,
  field
};

/** What carries the sensor. */
enum class EgoKind
{
  automatic,  //!< a robot on campus, a car elsewhere
  car,
  robot,
  handheld
};

/** All that decides what is simulated: equal options give equal bytes on any number of threads. */
struct SimulatorOptions : Options
{
  WorldKind world = WorldKind::urban;
  SensorKind sensor = SensorKind::hdl64e;
  double traffic = 0.4;  //!< 0 nothing moves .. 1 jammed
  int seed = 1;
  EgoKind ego = EgoKind::automatic;

  double ego_speed = 0;  //!< wanted cruising speed [m/s]; 0 takes what suits the world
  double loop_length =
      400;                //!< about how long the ego's closed loop is [m]; the world grows with it
  double start_time = 5;  //!< simulated before the first scan, so that traffic is under way [s]
  double start_fraction = 0;  //!< where on its loop the ego starts [0, 1)
  bool stops = true;          //!< the ego stops now and then for no reason

  bool motion_distortion = true;  //!< false: the whole sweep is taken at its stamp
  bool noise = true;              //!< false: every ray that hits returns the exact range
  int columns = 0;                //!< firings in one turn; 0 takes the sensor's
  double max_range = 0;           //!< [m]; 0 takes the sensor's
  double moving_speed = 0.2;      //!< bodies faster than this are labelled moving [m/s]

  void describe(OptionsVisitor& visitor) override;
};

/** "urban", "campus", "highway", "tunnel", "field". \throws UserError naming the nearest. */
[[nodiscard]] WorldKind worldKindFromString(const std::string& name);
[[nodiscard]] std::string toString(WorldKind kind);
}  // namespace dyslam::sim
