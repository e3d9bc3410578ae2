// SPDX-License-Identifier: BSD-3-Clause
#include "RecordedGround.h"

#include <dyslam/base/Angle.h>

#include <cmath>

namespace dyslam
{
namespace
{
/** Inclination below which the ground counts as level. */
constexpr double min_inclination = 4 * radians_per_degree;
/** Largest angle between the normals of planes that agree: a vehicle pitches and rolls. */
constexpr double same_ground = 4 * radians_per_degree;
/** Least share of the scans that have to show the same ground. */
constexpr double min_agreeing = 0.6;

/** The mean of planes that agree, and how many these are. */
struct Agreement
{
  GroundPlane mean;
  std::size_t count = 0;
};

/** Of the planes that agree with `one`. */
Agreement agreementWith(const GroundPlane& one, const std::vector<GroundPlane>& planes)
{
  GroundPlane sum{Eigen::Vector3d::Zero(), 0, 0};
  std::size_t count = 0;
  for (const GroundPlane& other : planes)
  {
    if (other.normal.dot(one.normal) >= std::cos(same_ground))
    {
      sum.normal += other.normal;
      sum.height += other.height;
      sum.share += other.share;
      ++count;
    }
  }
  const auto n = static_cast<double>(count);
  return {{sum.normal.normalized(), sum.height / n, sum.share / n}, count};
}
}  // namespace

void RecordedGround::add(const Scan& scan, std::size_t returns)
{
  const Eigen::Matrix3f R_vehicle_lidar = scan.T_vehicle_lidar.linear().cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.size());
  for (const Eigen::Vector3f& p : scan.points)
  {
    points.emplace_back(R_vehicle_lidar * p);
  }
  Searched searched{returns, findGroundPlane(points), std::nullopt};
  if (!searched.below)
  {
    searched.above = findGroundPlane(points, GroundSide::above);
  }
  scans_.push_back(searched);
}

std::optional<GroundPlane> RecordedGround::plane(GroundSide side, std::size_t min_returns) const
{
  std::vector<GroundPlane> planes;
  std::size_t scans = 0;
  for (const Searched& scan : scans_)
  {
    const auto& plane = side == GroundSide::below ? scan.below : scan.above;
    if (scan.returns >= min_returns)
    {
      ++scans;
      if (plane)
      {
        planes.push_back(*plane);
      }
    }
  }
  Agreement best;
  for (const GroundPlane& plane : planes)
  {
    const Agreement with_plane = agreementWith(plane, planes);
    best = with_plane.count > best.count ? with_plane : best;
  }
  const double least = min_agreeing * static_cast<double>(scans);
  const bool agree = best.count > 0 && static_cast<double>(best.count) >= least;
  return agree ? std::optional<GroundPlane>(best.mean) : std::nullopt;
}

bool isInclined(const std::optional<GroundPlane>& ground)
{
  return ground && ground->inclination() >= min_inclination;
}
}  // namespace dyslam
