// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/PoseInformation.h>

#include <cmath>

namespace dyslam
{
namespace
{
constexpr double least_cosine = 1e-3;

struct Angles
{
  double sine_pitch;
  double cosine_pitch;
  double sine_roll;
  double cosine_roll;
};

Angles anglesOf(const Pose& mean)
{
  const auto R = mean.linear();
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  if (cosine < least_cosine)
  {
    // The whole rotation about the vertical counts as yaw.
    return {std::copysign(std::sqrt(1 - least_cosine * least_cosine), -R(2, 0)), least_cosine, 0,
            1};
  }
  return {-R(2, 0), cosine, R(2, 1) / cosine, R(2, 2) / cosine};
}

Matrix6 scaledRotation(const Matrix6& information, double factor)
{
  Matrix6 scaled = information;
  scaled.topRightCorner<3, 3>() *= factor;
  scaled.bottomLeftCorner<3, 3>() *= factor;
  scaled.bottomRightCorner<3, 3>() *= factor * factor;
  return scaled;
}
}  // namespace

Matrix6 yprFromTangentJacobian(const Pose& mean)
{
  const Angles a = anglesOf(mean);
  Matrix6 jacobian = Matrix6::Zero();
  jacobian.topLeftCorner<3, 3>() = mean.linear();
  jacobian.bottomRightCorner<3, 3>() << 0, a.sine_roll / a.cosine_pitch,
      a.cosine_roll / a.cosine_pitch, 0, a.cosine_roll, -a.sine_roll, 1,
      a.sine_roll * a.sine_pitch / a.cosine_pitch, a.cosine_roll * a.sine_pitch / a.cosine_pitch;
  return jacobian;
}

Matrix6 tangentFromYprJacobian(const Pose& mean)
{
  const Angles a = anglesOf(mean);
  Matrix6 jacobian = Matrix6::Zero();
  jacobian.topLeftCorner<3, 3>() = mean.linear().transpose();
  jacobian.bottomRightCorner<3, 3>() << -a.sine_pitch, 0, 1, a.sine_roll * a.cosine_pitch,
      a.cosine_roll, 0, a.cosine_roll * a.cosine_pitch, -a.sine_roll, 0;
  return jacobian;
}

Matrix6 informationToYpr(const Pose& mean, const Matrix6& information)
{
  const Matrix6 jacobian = tangentFromYprJacobian(mean);
  const Matrix6 result = jacobian.transpose() * information * jacobian;
  return symmetricPart(result);
}

Matrix6 informationFromYpr(const Pose& mean, const Matrix6& information_ypr)
{
  const Matrix6 jacobian = yprFromTangentJacobian(mean);
  const Matrix6 result = jacobian.transpose() * information_ypr * jacobian;
  return symmetricPart(result);
}

Matrix6 informationToQuaternion(const Matrix6& information)
{
  return scaledRotation(information, 2);
}

Matrix6 informationFromQuaternion(const Matrix6& information_quaternion)
{
  return scaledRotation(information_quaternion, 0.5);
}
}  // namespace dyslam
