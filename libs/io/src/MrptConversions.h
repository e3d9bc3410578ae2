// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <mrpt/core/Clock.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <string>

namespace dyslam
{
[[nodiscard]] inline Pose toPose(const mrpt::poses::CPose3D& from)
{
  Pose pose = Pose::Identity();
  const auto& R = from.getRotationMatrix();
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      pose.matrix()(i, j) = R(i, j);
    }
  }
  pose.translation() = Eigen::Vector3d(from.x(), from.y(), from.z());
  return pose;
}

[[nodiscard]] inline mrpt::poses::CPose3D toMrpt(const Pose& from)
{
  mrpt::math::CMatrixDouble33 R;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      R(i, j) = from.matrix()(i, j);
    }
  }
  const auto t = from.translation();
  return mrpt::poses::CPose3D(R, mrpt::math::CVectorFixedDouble<3>({t.x(), t.y(), t.z()}));
}

/** MRPT counts 100 ns ticks since 1601. The 1970 epoch in those ticks: */
constexpr std::int64_t unix_epoch_ticks = 116444736000000000;

/** UNIX seconds. Both ways round to the nearest, so that text stamps are preserved. */
[[nodiscard]] inline double toStamp(mrpt::Clock::time_point time)
{
  // Of a damaged file: anything. Unsigned numbers wrap, signed ones must not.
  const auto ticks = static_cast<std::uint64_t>(time.time_since_epoch().count()) -
                     static_cast<std::uint64_t>(unix_epoch_ticks);
  return static_cast<double>(static_cast<std::int64_t>(ticks)) / 1e7;
}

[[nodiscard]] inline mrpt::Clock::time_point toMrptTime(double stamp)
{
  constexpr double farthest = 8e11;  // [s], 25 thousand years
  const double seconds = std::isfinite(stamp) ? std::clamp(stamp, -farthest, farthest) : 0.0;
  return mrpt::Clock::time_point(
      mrpt::Clock::duration(std::llround(seconds * 1e7) + unix_epoch_ticks));
}

/** The line of an MRPT exception's text that says what happened. */
[[nodiscard]] inline std::string messageOf(const std::exception& error)
{
  const std::string text = error.what();
  const std::string marker = "Message: ";
  const auto at = text.find(marker);
  const std::string tail = at == std::string::npos ? text : text.substr(at + marker.size());
  return tail.substr(0, tail.find('\n'));
}
}  // namespace dyslam
