// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace dyslam::sim
{
/** Unevenness of a road along the two wheel tracks of a car, in addition to the shape of the
 * ground. A sum of waves whose spectrum of heights falls with the square of the wave number (ISO
 * 8608). The mean of the tracks heaves and pitches a car, their difference rolls it. */
class RoadProfile
{
 public:
  /** \param roughness spectral density of the heights at 0.1 waves per metre [m^3]; 16e-6 is a good
   * road (ISO 8608, class A). */
  RoadProfile(std::uint64_t seed, double roughness);

  /** Mean height of the two tracks, low-pass filtered by the tyres at `wheel_hop` [m]. \param
   * distance distance driven [m] \param speed speed of the car [m/s] */
  [[nodiscard]] double height(double distance, double speed) const
  {
    return sum(middle_, distance, speed);
  }

  /** Height of the left wheel track above the right one, filtered as height() [m]. */
  [[nodiscard]] double leftAboveRight(double distance, double speed) const
  {
    return sum(difference_, distance, speed);
  }

  static constexpr double wheel_hop = 5;  //!< cut-off frequency of the tyres [Hz]

 private:
  struct Wave
  {
    double number = 0;     // angular wave number [rad/m]
    double amplitude = 0;  // amplitude of the height [m]
    double phase = 0;      // [rad]
  };
  static double sum(const std::vector<Wave>& waves, double distance, double speed);

  std::vector<Wave> middle_, difference_;
};
}  // namespace dyslam::sim
