// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace dyslam::sim
{
enum class SensorKind
{
  hdl64e,
  hdl32e,
  vlp16,
  vlp32c,
  vls128,
  os1_32,
  os1_64,
  os1_128,
  pandar64,
  xt32,
  avia
};

/** One laser of a LiDAR. */
struct Beam
{
  double elevation = 0;       //!< above the horizontal, or above the axis of a rosette [rad]
  double azimuth_offset = 0;  //!< added to the head's azimuth, counter-clockwise [rad]
  double fire_time = 0;       //!< time of firing after the start of the column [s]
  double height = 0;          //!< height of the laser above the sensor's origin [m]
};

/** Direction of a ray in the lidar frame [rad]. */
struct RayAngles
{
  double azimuth = 0;  //!< counter-clockwise from straight ahead
  double elevation = 0;
};

/** Two wedge prisms that turn in front of the lasers deflect them on a path that hardly repeats. */
struct Prisms
{
  double deflection = 0;   //!< deflection by each prism [rad]; 0: no prisms, the head spins
  double first_rate = 0;   //!< rate of the first prism [revolutions/s]
  double second_rate = 0;  //!< rate of the second prism [revolutions/s]
};

/** Model of a LiDAR: beams, rotation and measurement errors.
 *
 * A spinning head rotates clockwise seen from above. A sweep begins and ends facing backwards, so
 * that the stamp, in its middle, is the time at which the sensor faces forwards. A sensor with
 * prisms faces forward and has no rings.
 */
struct SensorModel
{
  std::string name;
  std::vector<Beam> beams;  //!< from the lowest to the highest; the index is the ring number
  Prisms prisms;
  int columns = 0;         //!< firings of each beam per sweep
  double period = 0.1;     //!< duration of a sweep (a revolution, if the head spins) [s]
  double min_range = 0.5;  //!< least range of a return [m]
  double max_range = 100;  //!< largest range of a return [m]

  double range_noise = 0.02;    //!< standard deviation for a bright target [m]
  double range_resolution = 0;  //!< quantisation of the range; 0 for none [m]
  double divergence = 0.0015;   //!< half angle of a beam [rad]
  double reference_range =
      60;  //!< range at which 10 % reflectivity is detected with probability 0.5 [m]
  double random_loss = 0.005;  //!< probability that a return is lost at random
  double beam_range_bias = 0;  //!< standard deviation of the beams' constant range errors [m]
  /** Standard deviation by which the elevations of the beams deviate from those listed [rad]: an
   * irregular spacing of the rings, not an error, because rays are cast and points are reported at
   * the same elevations. */
  double beam_angle_error = 0;

  /** Head azimuth at the start of column `c`, counter-clockwise from straight ahead [rad]. */
  [[nodiscard]] double azimuth(double column) const;
  /** Start of column `c` relative to the stamp [s], from -period/2. */
  [[nodiscard]] double columnTime(double column) const;
  [[nodiscard]] bool spins() const { return prisms.deflection == 0; }
  /** Direction of a beam of a sensor with prisms, `time` seconds after it was switched on. */
  [[nodiscard]] RayAngles throughPrisms(double time, const Beam& beam) const;
};

/** Model from the manufacturer's data sheet (beam table, firing times, range, accuracy). For the
 * Livox Avia only field of view, points per second, range and noise are published; the rates of its
 * prisms were measured on a Livox Mid-40, the order of its six lasers is assumed. */
[[nodiscard]] SensorModel sensorModel(SensorKind kind);

/** Names of the sensors, as of toString(): "HDL64E", "OS1-128", ... */
[[nodiscard]] std::vector<std::string> sensorNames();
/** The sensor of a name, in any case. \throws UserError naming the nearest. */
[[nodiscard]] SensorKind sensorKindFromString(const std::string& name);
[[nodiscard]] std::string toString(SensorKind kind);
}  // namespace dyslam::sim
