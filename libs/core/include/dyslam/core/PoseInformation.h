// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

namespace dyslam
{
/** Conversions of information matrices between coordinates.
 *
 * DySLAM's are over the tangent x = [translation, rotation] of T = T_mean exp(x). MRPT's
 * CPose3DPDFGaussianInf is over the coordinates (x, y, z, yaw, pitch, roll) of T about those of
 * T_mean. g2o's EDGE_SE3:QUAT is over the translation and the vector part of the quaternion of
 * T_mean^-1 T, which is half a small rotation.
 */

/** d(x, y, z, yaw, pitch, roll) / d(tangent) at the mean; tangent order [translation, rotation].
 *
 * Yaw and roll are the same motion at a pitch of 90 degrees. Closer than 0.06 degrees to it the
 * matrix is that of 0.06 degrees, so that it keeps an inverse; there the numbers deviate from
 * MRPT's definition, but the conversion in both directions still gives the same matrix.
 */
[[nodiscard]] Matrix6 yprFromTangentJacobian(const Pose& mean);
/** Inverse of yprFromTangentJacobian(). */
[[nodiscard]] Matrix6 tangentFromYprJacobian(const Pose& mean);

/** Information over the tangent to and from information over x, y, z, yaw, pitch, roll. */
[[nodiscard]] Matrix6 informationToYpr(const Pose& mean, const Matrix6& information);
[[nodiscard]] Matrix6 informationFromYpr(const Pose& mean, const Matrix6& information_ypr);

/** Information over the tangent to and from that over translation and quaternion vector part. */
[[nodiscard]] Matrix6 informationToQuaternion(const Matrix6& information);
[[nodiscard]] Matrix6 informationFromQuaternion(const Matrix6& information_quaternion);
}  // namespace dyslam
