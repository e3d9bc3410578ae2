// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** A rigid motion. `T_a_b` takes points of frame b to frame a. Lengths are metres. */
using Pose = Eigen::Isometry3d;
/** A tangent of SE(3): [translation, rotation], metres and radians, as mrpt::poses::Lie::SE<3>. */
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/** (M + M^T) / 2. */
[[nodiscard]] inline Matrix6 symmetricPart(const Matrix6& M)
{
  return 0.5 * (M + M.transpose());
}

[[nodiscard]] Eigen::Matrix3d skew(const Eigen::Vector3d& v);

/** Rotation vector to rotation matrix and back; logSO3 returns an angle in [0, pi]. */
[[nodiscard]] Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotation);
[[nodiscard]] Eigen::Vector3d logSO3(const Eigen::Matrix3d& rotation);

/** Exponential and logarithm of SE(3), with the coupled translation (not the pseudo variants). */
[[nodiscard]] Pose expSE3(const Vector6& tangent);
[[nodiscard]] Vector6 logSE3(const Pose& pose);

/** Adjoint: exp(Ad(T) x) = T exp(x) T^-1. */
[[nodiscard]] Matrix6 adjointSE3(const Pose& pose);

/** Inverse of the right Jacobian: log(exp(x) exp(d)) = x + J d + O(d^2). */
[[nodiscard]] Matrix6 rightJacobianInverseSE3(const Vector6& tangent);

/** Pose on the geodesic from a (fraction 0) to b (fraction 1); extrapolates outside. */
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double fraction);

/** Angle of the rotation, radians in [0, pi]. */
[[nodiscard]] double rotationAngle(const Pose& pose);

/** Size of a motion or a step: |translation| + lever |rotation| [m]. */
[[nodiscard]] double motionSize(const Vector6& tangent, double lever = 10);

/** x, y, z [m] and yaw, pitch, roll [rad] (R = Rz(yaw) Ry(pitch) Rx(roll), as MRPT's CPose3D). */
[[nodiscard]] Pose poseFromYpr(double x, double y, double z, double yaw, double pitch, double roll);
[[nodiscard]] Eigen::Vector3d yawPitchRoll(const Pose& pose);
/** "x y z yaw pitch roll" [m, deg] to a millionth, as options such as --sensor-pose take a pose. */
[[nodiscard]] std::string poseText(const Pose& pose);
/** The pose of such a text, also with commas between the numbers; nothing for any other text. */
[[nodiscard]] std::optional<Pose> poseFromText(std::string text);

/** The pose with its rotation replaced by the nearest proper rotation: for poses read from text and
 * for long products. */
[[nodiscard]] Pose orthonormalised(const Pose& pose);

/** Poses of a sensor in its first frame, from those of another one that is rigidly mounted with it,
 * in the first frame of that one.
 * \param T_given_wanted pose of the wanted sensor in the frame of the given one: for poses of the
 * lidar from those of the camera, T_cam_velo (`Tr` of KITTI's calib.txt); its inverse converts them
 * back */
[[nodiscard]] std::vector<Pose> posesOfMountedSensor(const std::vector<Pose>& poses,
                                                     const Pose& T_given_wanted);
}  // namespace dyslam
