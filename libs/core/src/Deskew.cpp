// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <dyslam/core/FastAngle.h>

#include <cmath>

namespace dyslam
{
float sweepFraction(const Eigen::Vector3f& p, const SweepModel& model)
{
  constexpr double inverse_two_pi = 0.15915494309189535;
  const auto start = static_cast<float>(model.start_azimuth * inverse_two_pi);
  const float turned = static_cast<float>(model.direction) * (turnsOf(p.y(), p.x()) - start);
  const float fraction = turned - std::floor(turned);
  return fraction < 1.0F ? fraction : 0.0F;
}

SweepMotion::SweepMotion(const Pose& T_start_end, double reference)
    : reference_(static_cast<float>(reference))
{
  const Vector6 twist = logSE3(T_start_end);
  const Eigen::Vector3d w = twist.tail<3>();
  const Eigen::Vector3d v = twist.head<3>();
  rotation_ = w.cast<float>();
  translation_ = v.cast<float>();
  w_translation_ = w.cross(v).cast<float>();
  ww_translation_ = w.cross(w.cross(v)).cast<float>();
  angle2_ = static_cast<float>(w.squaredNorm());
}
}  // namespace dyslam
