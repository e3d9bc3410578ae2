// SPDX-License-Identifier: BSD-3-Clause
#include "EgoMotion.h"

#include <dyslam/base/Angle.h>

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
namespace
{
constexpr double kRoughness = 80e-6;  // an average road (ISO 8608, class B) [m^3]
}

EgoMotion::EgoMotion(EgoKind kind, std::uint64_t seed)
    : kind_(kind), road_(seed, kind == EgoKind::car ? kRoughness : 0)
{
  Rng rng(combine(seed, 0xE60));
  for (auto& w : wobble_)
  {
    w = rng.uniform(0, 6.283185);
  }
}

Pose EgoMotion::mounting(EgoKind kind)
{
  switch (kind)
  {
    case EgoKind::robot:
      return Pose(Eigen::Translation3d(0.1, 0, 0.75));
    case EgoKind::handheld:
      return Pose(Eigen::Translation3d(0, 0, 1.45));
    case EgoKind::car:
    case EgoKind::automatic:
      break;
  }
  return Pose(Eigen::Translation3d(0, 0, 1.73));
}

std::array<double, 3> EgoMotion::equilibrium(const EgoState& ego, const Ground& ground, double dt)
{
  const double wheelbase = kind_ == EgoKind::car ? 2.7 : 0.5;
  const double track = kind_ == EgoKind::car ? 1.5 : 0.5;
  const Eigen::Vector2d forward(std::cos(ego.yaw), std::sin(ego.yaw)),
      left(-forward.y(), forward.x());
  distance_ += ego.speed * dt;
  const auto height = [&](const Eigen::Vector2d& p) { return ground.height(p); };
  const double front = height(ego.position + 0.5 * wheelbase * forward) +
                       road_.height(distance_ + 0.5 * wheelbase, ego.speed);
  const double back = height(ego.position - 0.5 * wheelbase * forward) +
                      road_.height(distance_ - 0.5 * wheelbase, ego.speed);
  const double port = height(ego.position + 0.5 * track * left);
  const double starboard = height(ego.position - 0.5 * track * left);
  const double lean = 0.5 * (road_.leftAboveRight(distance_ + 0.5 * wheelbase, ego.speed) +
                             road_.leftAboveRight(distance_ - 0.5 * wheelbase, ego.speed));
  const double slope = -std::atan2(front - back, wheelbase),
               bank = std::atan2(port - starboard + lean, track);

  const double acceleration = first_ ? 0 : (ego.speed - speed_) / dt;
  const double turn = first_ ? 0 : wrapAngle(ego.yaw - yaw_) / dt;
  speed_ = ego.speed;
  yaw_ = ego.yaw;
  // Braking pitches the nose down (pitch > 0); a left turn rolls the body to the right (roll > 0).
  return kind_ == EgoKind::car
             ? std::array<double, 3>{slope - 0.006 * acceleration, bank + 0.005 * ego.speed * turn,
                                     0.5 * (front + back)}
             : std::array<double, 3>{slope, bank, 0.5 * (front + back)};
}

void EgoMotion::moveOnSprings(const std::array<double, 3>& rest, double dt)
{
  // Natural frequencies [rad/s] and damping ratio of pitch, roll and height. With them and the road
  // a car's angular rates are those of real cars' gyroscopes.
  const bool car = kind_ == EgoKind::car;
  const std::array<double, 3> frequency =
      car ? std::array<double, 3>{10, 8, 10} : std::array<double, 3>{14, 14, 16};
  const double damping = car ? 0.4 : 0.35;
  for (std::size_t i = 0; i < 3; ++i)
  {
    if (first_)
    {
      x_[i] = rest[i];
    }
    const double pull =
        frequency[i] * frequency[i] * (rest[i] - x_[i]) - 2 * damping * frequency[i] * rate_[i];
    rate_[i] += pull * dt;
    x_[i] += rate_[i] * dt;
  }
}

Pose EgoMotion::gait(double speed, double time, double dt)
{
  Eigen::Vector3d shift = Eigen::Vector3d::Zero(),
                  angles = Eigen::Vector3d::Zero();  // yaw, pitch, roll
  const auto wave = [&](double hertz, std::size_t k)
  { return std::sin(6.283185 * hertz * time + wobble_[k]); };
  if (kind_ == EgoKind::handheld)
  {
    // Two steps per stride, and hand tremor. The frequency of the steps of walking adults grows
    // with the speed to the power of 0.58 (Grieve and Gear, 1966): 1.9 Hz at 1.4 m/s.
    const double steps = 1.58 * std::pow(std::max(0.0, speed), 0.58);  // [Hz]
    phase_ += 6.283185 * steps / 2 * dt;
    const double walk = std::min(1.0, speed);
    shift = {0.01 * wave(0.7, 0), walk * 0.025 * std::sin(phase_) + 0.01 * wave(0.5, 1),
             walk * 0.022 * std::cos(2 * phase_)};
    angles = {0.05 * wave(0.4, 2) + walk * 0.02 * std::sin(phase_),
              0.04 * wave(0.55, 3) + walk * 0.012 * std::sin(2 * phase_),
              0.04 * wave(0.47, 4) + walk * 0.02 * std::cos(phase_)};
  }
  else if (kind_ == EgoKind::robot)
  {
    const double rough = std::min(1.0, speed);
    // Pitch and roll rates up to 0.07 rad/s, as on a paved path.
    angles = {0, rough * 0.0032 * wave(3.3, 5), rough * 0.0045 * wave(2.4, 6)};
    shift.z() = rough * 0.003 * wave(6.7, 7);
  }
  return poseFromYpr(shift.x(), shift.y(), shift.z(), angles.x(), angles.y(), angles.z());
}

Pose EgoMotion::update(const EgoState& ego, const Ground& ground, double time, double dt)
{
  moveOnSprings(equilibrium(ego, ground, dt), dt);
  first_ = false;
  return poseFromYpr(ego.position.x(), ego.position.y(), x_[2], ego.yaw, x_[0], x_[1]) *
         gait(ego.speed, time, dt);
}
}  // namespace dyslam::sim
