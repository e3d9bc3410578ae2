// SPDX-License-Identifier: BSD-3-Clause
#include "RoadProfile.h"

#include <cmath>

#include "Random.h"

namespace dyslam::sim
{
namespace
{
constexpr double kTwoPi = 2 * M_PI;
constexpr int kWaves = 30;
constexpr double kLongest = 60, kShortest = 1.2;  // wavelengths [m]
constexpr double kReference = 0.1;                // wave number of the roughness [waves/m]
constexpr double kApart = 10;  // wavelength above which the two tracks rise and fall together [m]
}  // namespace

RoadProfile::RoadProfile(std::uint64_t seed, double roughness)
{
  Rng rng(combine(seed, 0x20AD));
  const double ratio = std::pow(kLongest / kShortest, 1.0 / kWaves);
  for (int i = 0; i < kWaves; ++i)
  {
    const double number = std::pow(ratio, i + rng.uniform()) / kLongest;  // [waves/m]
    const double width = number * (std::sqrt(ratio) - 1 / std::sqrt(ratio));
    const double density = roughness * kReference * kReference / (number * number);
    const double amplitude = std::sqrt(2 * density * width);
    // The mean and the difference of two tracks that each have this spectrum.
    const double apart = number * kApart / std::hypot(1.0, number * kApart);
    Wave middle{kTwoPi * number, amplitude * std::sqrt(1 - 0.5 * apart * apart), 0};
    middle.phase = rng.uniform(0, kTwoPi);
    Wave difference{kTwoPi * number, amplitude * apart * std::sqrt(2.0), 0};
    difference.phase = rng.uniform(0, kTwoPi);
    middle_.push_back(middle);
    difference_.push_back(difference);
  }
}

double RoadProfile::sum(const std::vector<Wave>& waves, double distance, double speed)
{
  double height = 0;
  for (const Wave& w : waves)
  {
    const double often = w.number * speed / (kTwoPi * wheel_hop);
    height += w.amplitude / (1 + often * often) * std::sin(w.number * distance + w.phase);
  }
  return height;
}

}  // namespace dyslam::sim
