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
  os1_64,
  os1_128
};

/** One laser of a spinning LiDAR. */
struct Beam
{
  double elevation = 0;       //!< above the horizontal [rad]
  double azimuth_offset = 0;  //!< added to the head's azimuth, counter-clockwise [rad]
  double fire_time = 0;       //!< after the start of its column [s]
};

/** Model of a spinning LiDAR: beams, rotation and measurement errors.
 *
 * The head rotates clockwise seen from above. A sweep begins and ends facing backwards, so that the
 * stamp, in its middle, is the time at which the sensor faces forwards.
 */
struct SensorModel
{
  std::string name;
  std::vector<Beam> beams;  //!< from the lowest to the highest; the index is the ring number
  int columns = 0;          //!< firings of each beam per revolution
  double period = 0.1;      //!< of one revolution [s]
  double min_range = 0.5;   //!< [m]
  double max_range = 100;   //!< [m]

  double range_noise = 0.02;    //!< standard deviation for a bright target [m]
  double range_resolution = 0;  //!< quantisation of the range; 0 for none [m]
  double divergence = 0.0015;   //!< half angle of a beam [rad]
  double reference_range =
      60;  //!< range at which 10 % reflectivity is detected with probability 0.5 [m]
  double random_loss = 0.005;   //!< probability that a return is lost at random
  double beam_range_bias = 0;   //!< standard deviation of the beams' constant range errors [m]
  double beam_angle_error = 0;  //!< standard deviation of the beams' elevation errors [rad]

  /** Head azimuth at the start of column `c`, counter-clockwise from straight ahead [rad]. */
  [[nodiscard]] double azimuth(double column) const;
  /** Start of column `c` relative to the stamp [s], from -period/2. */
  [[nodiscard]] double columnTime(double column) const;
};

/** Model from the manufacturer's data sheet (beam table, firing times, range, accuracy). */
[[nodiscard]] SensorModel sensorModel(SensorKind kind);

/** "HDL64E", "HDL32E", "VLP16", "OS1-64", "OS1-128", in any case. \throws UserError. */
[[nodiscard]] SensorKind sensorKindFromString(const std::string& name);
[[nodiscard]] std::string toString(SensorKind kind);
}  // namespace dyslam::sim
