// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/mrpt/Conversions.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dyslam
{
namespace
{
constexpr std::int64_t unix_epoch_ticks = 116444736000000000;  // 1970, in ticks since 1601
constexpr double ticks_per_second = 1e7;
}  // namespace

Pose toPose(const mrpt::poses::CPose3D& from)
{
  Pose pose = Pose::Identity();
  pose.linear() = from.getRotationMatrix().asEigen();
  pose.translation() = Eigen::Vector3d(from.x(), from.y(), from.z());
  return pose;
}

mrpt::poses::CPose3D toMrpt(const Pose& from)
{
  return mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(from.matrix()));
}

double toStamp(mrpt::Clock::time_point time)
{
  // The time of a damaged file may be any number: unsigned numbers may wrap, signed ones must not.
  const auto ticks = static_cast<std::uint64_t>(time.time_since_epoch().count()) -
                     static_cast<std::uint64_t>(unix_epoch_ticks);
  return static_cast<double>(static_cast<std::int64_t>(ticks)) / ticks_per_second;
}

mrpt::Clock::time_point toMrptTime(double stamp)
{
  constexpr double farthest = 8e11;  // [s], 25 thousand years
  const double seconds = std::isfinite(stamp) ? std::clamp(stamp, -farthest, farthest) : 0.0;
  return mrpt::Clock::time_point(
      mrpt::Clock::duration(std::llround(seconds * ticks_per_second) + unix_epoch_ticks));
}
}  // namespace dyslam
