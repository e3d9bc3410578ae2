// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Pose.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

namespace dyslam
{
namespace
{
constexpr double small_angle = 1e-5;

/** V of SE(3)'s exponential: exp([u, w]) has the translation V(w) u. Also SO(3)'s left Jacobian. */
Eigen::Matrix3d leftJacobianSO3(const Eigen::Vector3d& w)
{
  const double theta2 = w.squaredNorm();
  const double theta = std::sqrt(theta2);
  const Eigen::Matrix3d W = skew(w);
  if (theta < small_angle)
  {
    return Eigen::Matrix3d::Identity() + 0.5 * W + (1.0 / 6.0) * W * W;
  }
  return Eigen::Matrix3d::Identity() + (1 - std::cos(theta)) / theta2 * W +
         (theta - std::sin(theta)) / (theta2 * theta) * W * W;
}

Eigen::Matrix3d leftJacobianInverseSO3(const Eigen::Vector3d& w)
{
  const double theta2 = w.squaredNorm();
  const double theta = std::sqrt(theta2);
  const Eigen::Matrix3d W = skew(w);
  double factor = 1.0 / 12.0;
  if (theta >= small_angle)
  {
    factor = 1 / theta2 - (1 + std::cos(theta)) / (2 * theta * std::sin(theta));
  }
  return Eigen::Matrix3d::Identity() - 0.5 * W + factor * W * W;
}

/** The coupling block Q of SE(3)'s left Jacobian (Barfoot, State Estimation for Robotics, 7.86). */
Eigen::Matrix3d couplingBlock(const Eigen::Vector3d& u, const Eigen::Vector3d& w)
{
  const Eigen::Matrix3d U = skew(u);
  const Eigen::Matrix3d W = skew(w);
  const double theta2 = w.squaredNorm();
  const double theta = std::sqrt(theta2);
  double a = 1.0 / 6.0;
  double b = 1.0 / 24.0;
  double c = 1.0 / 120.0;
  if (theta > 1e-2)
  {
    const double sine = std::sin(theta);
    const double cosine = std::cos(theta);
    const double theta3 = theta2 * theta;
    const double theta4 = theta2 * theta2;
    const double theta5 = theta4 * theta;
    a = (theta - sine) / theta3;
    b = (theta2 + 2 * cosine - 2) / (2 * theta4);
    c = (2 * theta - 3 * sine + theta * cosine) / (2 * theta5);
  }
  return 0.5 * U + a * (W * U + U * W + W * U * W) + b * (W * W * U + U * W * W - 3 * W * U * W) +
         c * (W * U * W * W + W * W * U * W);
}

/** To a millionth, as products of rotations leave 1e-16 instead of 0; never a negative zero. */
double millionths(double value)
{
  return std::round(1e6 * value) / 1e6 + 0.0;
}
}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& v)
{
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotation)
{
  const double theta = rotation.norm();
  if (theta < 1e-12)
  {
    return Eigen::Matrix3d::Identity() + skew(rotation);
  }
  return Eigen::AngleAxisd(theta, rotation / theta).toRotationMatrix();
}

Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation)
{
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0)
  {
    q.coeffs() = -q.coeffs();
  }
  const double sine_half = q.vec().norm();
  if (sine_half < 1e-12)
  {
    return 2 * q.vec();
  }
  return 2 * std::atan2(sine_half, q.w()) / sine_half * q.vec();
}

Pose expSE3(const Vector6& tangent)
{
  Pose pose = Pose::Identity();
  pose.linear() = expSO3(tangent.tail<3>());
  pose.translation() = leftJacobianSO3(tangent.tail<3>()) * tangent.head<3>();
  return pose;
}

Vector6 logSE3(const Pose& pose)
{
  Vector6 tangent;
  tangent.tail<3>() = logSO3(pose.linear());
  tangent.head<3>() = leftJacobianInverseSO3(tangent.tail<3>()) * pose.translation();
  return tangent;
}

Matrix6 adjointSE3(const Pose& pose)
{
  Matrix6 adjoint = Matrix6::Zero();
  adjoint.topLeftCorner<3, 3>() = pose.linear();
  adjoint.bottomRightCorner<3, 3>() = pose.linear();
  adjoint.topRightCorner<3, 3>() = skew(pose.translation()) * pose.linear();
  return adjoint;
}

Matrix6 rightJacobianInverseSE3(const Vector6& tangent)
{
  // The right Jacobian at x is the left one at -x.
  const Eigen::Vector3d u = -tangent.head<3>();
  const Eigen::Vector3d w = -tangent.tail<3>();
  const Eigen::Matrix3d inverse = leftJacobianInverseSO3(w);
  Matrix6 jacobian = Matrix6::Zero();
  jacobian.topLeftCorner<3, 3>() = inverse;
  jacobian.bottomRightCorner<3, 3>() = inverse;
  jacobian.topRightCorner<3, 3>() = -inverse * couplingBlock(u, w) * inverse;
  return jacobian;
}

Pose interpolate(const Pose& a, const Pose& b, double fraction)
{
  return a * expSE3(fraction * logSE3(a.inverse() * b));
}

double rotationAngle(const Pose& pose)
{
  return logSO3(pose.linear()).norm();
}

double motionSize(const Vector6& tangent, double lever)
{
  return tangent.head<3>().norm() + lever * tangent.tail<3>().norm();
}

Pose poseFromYpr(double x, double y, double z, double yaw, double pitch, double roll)
{
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                   Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                      .toRotationMatrix();
  return pose;
}

Eigen::Vector3d yawPitchRoll(const Pose& pose)
{
  const auto R = pose.linear();
  const double horizontal = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), horizontal);
  if (horizontal < 1e-9)
  {
    return {std::atan2(-R(0, 1), R(1, 1)), pitch, 0.0};
  }
  return {std::atan2(R(1, 0), R(0, 0)), pitch, std::atan2(R(2, 1), R(2, 2))};
}

std::string poseText(const Pose& pose)
{
  const Eigen::Vector3d t = pose.translation();
  const Eigen::Vector3d angles = degrees_per_radian * yawPitchRoll(pose);
  return formatted("%.7g %.7g %.7g %.7g %.7g %.7g", millionths(t.x()), millionths(t.y()),
                   millionths(t.z()), millionths(angles.x()), millionths(angles.y()),
                   millionths(angles.z()));
}

std::optional<Pose> poseFromText(std::string text)
{
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream words(text);
  std::vector<double> v;
  for (double value = 0; words >> value;)
  {
    v.push_back(value);
  }
  if (!words.eof() || v.size() != 6)
  {
    return std::nullopt;
  }
  constexpr double rad = radians_per_degree;
  return poseFromYpr(v[0], v[1], v[2], rad * v[3], rad * v[4], rad * v[5]);
}

Pose orthonormalised(const Pose& pose)
{
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(pose.linear(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0)
  {
    U.col(2) = -U.col(2);
  }
  Pose result = pose;
  result.linear() = U * svd.matrixV().transpose();
  return result;
}

std::vector<Pose> posesOfMountedSensor(const std::vector<Pose>& poses, const Pose& T_given_wanted)
{
  std::vector<Pose> result;
  result.reserve(poses.size());
  const Pose T_wanted_given = T_given_wanted.inverse();
  for (const Pose& pose : poses)
  {
    result.push_back(T_wanted_given * pose * T_given_wanted);
  }
  return result;
}
}  // namespace dyslam
