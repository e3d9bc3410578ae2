// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Pose.h>
#include <dyslam/sim/Sensor.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam::sim
{
enum class WorldKind
{
  urban,
  campus,
  highway,
  tunnel,
  field,
  downtown,
  indoor
};

/** Carrier of the sensor. */
enum class EgoKind
{
  automatic,  //!< a robot on campus and indoors, a car elsewhere
  car,
  robot,
  handheld
};

/** Another lidar of the ego. */
struct FurtherSensor
{
  SensorKind sensor = SensorKind::vlp16;
  Pose T_vehicle_lidar = Pose::Identity();
};

/** Simulation parameters. Equal options give equal bytes on any number of threads. */
struct SimulatorOptions : Options
{
  WorldKind world = WorldKind::urban;
  SensorKind sensor = SensorKind::hdl64e;
  double traffic = 0.4;  //!< traffic density, from 0 (nothing moves) to 1 (jam)
  int seed = 1;
  int traffic_seed = -1;  //!< seed of traffic, ego-motion and noise; below 0: seed
  EgoKind ego = EgoKind::automatic;

  double ego_speed = 0;  //!< cruising speed [m/s]; 0 for the default of the world
  /** Approximate length of the ego's closed loop [m]; sets the world's size. Highways and tunnels
   * have 1500 m at least, streets are driven around one block at least; indoors 150 to 600 m. */
  double loop_length = 400;
  double start_time = 5;      //!< time simulated before the first scan [s]
  double start_fraction = 0;  //!< start of the ego on its loop, in [0, 1)
  bool reverse = false;  //!< the ego drives its loop in the opposite direction; not on a highway
  bool stops = true;     //!< the ego stops at random times

  double mounting_roll = 0;   //!< roll of the first lidar about the ego's x axis [rad]
  double mounting_pitch = 0;  //!< its pitch about the ego's y axis [rad]; > 0: downwards

  std::vector<FurtherSensor> further_sensors;  //!< have the first sensor's period and stamps

  bool motion_distortion = true;  //!< false: all points are measured at the stamp
  bool noise = true;  //!< false: exact ranges without losses, also at the car's own roof; exact IMU
                      //!< and wheels
  int columns = 0;    //!< firings per revolution of the first lidar; 0: default of the sensor
  double max_range = 0;       //!< largest range of a return [m]; 0: default of the sensor
  double moving_speed = 0.2;  //!< speed above which bodies are labelled moving [m/s]

  bool imu = false;     //!< simulate an IMU: SimulatedScan::imu
  bool wheels = false;  //!< simulate wheel odometry: SimulatedScan::wheels; not hand-held

  /** Seed of traffic, ego-motion and noise. */
  [[nodiscard]] std::uint64_t trafficSeed() const
  {
    return static_cast<std::uint64_t>(traffic_seed < 0 ? seed : traffic_seed);
  }
  void describe(OptionsVisitor& visitor) override;
};

/** "urban", "campus", "highway", "tunnel", "field", "downtown", "indoor". \throws UserError
 * naming the nearest. */
[[nodiscard]] WorldKind worldKindFromString(const std::string& name);
[[nodiscard]] std::string toString(WorldKind kind);
/** "automatic", "car", "robot", "handheld". \throws UserError naming the nearest. */
[[nodiscard]] EgoKind egoKindFromString(const std::string& name);
}  // namespace dyslam::sim
