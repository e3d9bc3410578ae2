// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <array>
#include <vector>

#include "traffic/Traffic.h"
#include "worlds/RoadProfile.h"

namespace dyslam::sim
{
/** Six-degree-of-freedom motion of the carrier: a car's body on its springs, driven by the road;
 * the gait of a robot or of a person with the sensor on a pole. */
class EgoMotion
{
 public:
  EgoMotion(EgoKind kind, std::uint64_t seed);

  /** Advances by one step. \param ego planar state \param time since the start [s] \param dt step
   * [s] \return T_map_vehicle */
  [[nodiscard]] Pose update(const EgoState& ego, const Ground& ground, double time, double dt);

  /** T_vehicle_lidar; the vehicle's origin is on the ground. */
  [[nodiscard]] static Pose mounting(EgoKind kind);

 private:
  /** Advances along the road. \return pitch [rad], roll [rad] and height [m] at which the springs
   * would be at rest on the ground below the wheels, with the forces of accelerating and turning */
  [[nodiscard]] std::array<double, 3> equilibrium(const EgoState& ego,
                                                  const Ground& ground,
                                                  double dt);
  /** Moves pitch, roll and height by one step. \param rest as of equilibrium() */
  void moveOnSprings(const std::array<double, 3>& rest, double dt);
  /** Motion in addition to that of the springs: steps and hands of a person, shaking of a robot,
   * none of a car. */
  [[nodiscard]] Pose gait(double speed, double time, double dt);

  EgoKind kind_;
  RoadProfile road_;
  double distance_ = 0;  // distance driven [m]
  double phase_ = 0;
  double speed_ = 0, yaw_ = 0;
  bool first_ = true;
  // Deflections and their rates: pitch [rad], roll [rad], height [m].
  std::array<double, 3> x_{}, rate_{};
  std::array<double, 9> wobble_{};
};
}  // namespace dyslam::sim
