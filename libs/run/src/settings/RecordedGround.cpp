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
  GroundPlane best;
  std::size_t most = 0;
  for (const GroundPlane& one : planes)
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
    if (count > most)
    {
      const auto n = static_cast<double>(count);
      best = {sum.normal.normalized(), sum.height / n, sum.share / n};
      most = count;
    }
  }
  const bool agree = static_cast<double>(most) >= min_agreeing * static_cast<double>(scans);
  return most > 0 && agree ? std::optional<GroundPlane>(best) : std::nullopt;
}

bool isInclined(const std::optional<GroundPlane>& ground)
{
  return ground && ground->inclination() >= min_inclination;
}
}  // namespace dyslam
