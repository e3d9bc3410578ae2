// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Scan.h>
#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace dyslam
{
namespace
{
/** Returns at these distances from the sensor are used [m]. */
constexpr float min_range = 1;
constexpr float max_range = 15;
/** Side of the cubes of which one return each is used [m]: most returns are close to the sensor. */
constexpr float cube = 0.5F;
constexpr std::size_t min_cubes = 100;
/** Distance beyond which the weight of a return falls [m]: a road is most level near the sensor. */
constexpr float full_weight_range = 3;

constexpr int draws = 1500;
/** Every sample_step-th point decides whether a plane is evaluated on all points: the support in
 * the sample has to be at least this share of the best plane's. */
constexpr std::size_t sample_step = 8;
constexpr double promising = 0.6;
/** Sides of the triangles that are drawn [m]. */
constexpr double min_side = 2;
/** Range of the height of the origin above the ground [m]; some drivers have it on the ground. */
constexpr double min_height = -0.5;
constexpr double max_height = 6;
const double max_inclination = 50 * radians_per_degree;

/** Largest distance of ground points from a drawn plane and from the final one [m]. */
constexpr double drawn_distance = 0.15;
constexpr double final_distance = 0.08;
/** Distance behind a plane from which points are evidence that it is not the ground [m]. */
constexpr double behind = 0.4;
/** Largest ratio of points behind the ground to points on it. */
constexpr double max_behind = 0.5;
/** Least share of the weights of all points on the ground. */
constexpr double min_share = 0.15;
/** Least standard deviation of the ground points along the direction where it is smaller [m]. */
constexpr double min_spread = 1.5;
/** Least share of the weights above a sensor that hangs upside down. */
constexpr double min_share_above = 2.0 / 3;

struct Point
{
  Eigen::Vector3d p;
  double weight;
};
using Points = std::vector<Point>;

/** One return of each cube near the sensor, in the order of the points. */
Points thinned(const std::vector<Eigen::Vector3f>& points)
{
  Points kept;
  VoxelHash taken;
  for (const Eigen::Vector3f& p : points)
  {
    const float range = p.norm();
    if (!isReturn(p) || range < min_range || range > max_range)
    {
      continue;
    }
    const auto next = static_cast<std::uint32_t>(kept.size());
    if (taken.findOrInsert(voxelKey(voxelCell(p, 1 / cube)), next) == next)
    {
      kept.push_back({p.cast<double>(), 1 / std::max(range, full_weight_range)});
    }
  }
  return kept;
}

double totalWeight(const Points& points)
{
  double sum = 0;
  for (const Point& point : points)
  {
    sum += point.weight;
  }
  return sum;
}

bool areMostlyAbove(const Points& points)
{
  double above = 0;
  for (const Point& point : points)
  {
    above += point.p.z() > 0 ? point.weight : 0;
  }
  return above >= min_share_above * totalWeight(points);
}

/** Points of a plane are those with normal . p + height near 0; its normal points upwards. */
struct Plane
{
  Eigen::Vector3d normal;
  double height;

  [[nodiscard]] double above(const Eigen::Vector3d& p) const { return normal.dot(p) + height; }
  [[nodiscard]] bool isPossible() const
  {
    return height >= min_height && height <= max_height &&
           std::abs(normal.z()) >= std::cos(max_inclination);
  }
};

/** Weights of the points on a plane, and of those behind it. */
struct Support
{
  double on = 0;
  double behind = 0;

  [[nodiscard]] bool isOfGround() const { return behind <= max_behind * on; }
};

Support supportOf(const Plane& plane, const Points& points)
{
  Support support;
  for (const Point& point : points)
  {
    const double above = plane.above(point.p);
    support.on += std::abs(above) <= drawn_distance ? point.weight : 0;
    support.behind += above < -behind ? point.weight : 0;
  }
  return support;
}

/** Least-squares plane through the points nearer than `distance` [m] to `plane`.
 * \param spread standard deviations along the plane: the smaller one [m] */
Plane fitted(const Plane& plane, const Points& points, double distance, double& spread)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  double weight = 0;
  for (const Point& point : points)
  {
    if (std::abs(plane.above(point.p)) <= distance)
    {
      sum += point.weight * point.p;
      squares += point.weight * point.p * point.p.transpose();
      weight += point.weight;
    }
  }
  spread = 0;
  if (weight <= 0)
  {
    return plane;
  }
  const Eigen::Vector3d mean = sum / weight;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(squares / weight -
                                                              mean * mean.transpose());
  spread = std::sqrt(std::max(0.0, solver.eigenvalues()[1]));
  Eigen::Vector3d normal = solver.eigenvectors().col(0);
  normal *= normal.dot(plane.normal) < 0 ? -1 : 1;
  return {normal, -normal.dot(mean)};
}

/** The best plane of those drawn. \param up sign of the z coordinate of its normal */
std::optional<Plane> drawPlane(const Points& points, double up)
{
  Points sample;
  for (std::size_t i = 0; i < points.size(); i += sample_step)
  {
    sample.push_back(points[i]);
  }
  std::optional<Plane> best;
  double most = 0;
  std::mt19937 random(1);
  const auto draw = [&points, &random]() -> const Eigen::Vector3d&
  { return points[random() % static_cast<std::uint32_t>(points.size())].p; };
  for (int i = 0; i < draws; ++i)
  {
    const Eigen::Vector3d& a = draw();
    const Eigen::Vector3d& b = draw();
    const Eigen::Vector3d& c = draw();
    Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < min_side * min_side)
    {
      continue;
    }
    normal *= (up * normal.z() < 0 ? -1 : 1) / normal.norm();
    const Plane plane{normal, -normal.dot(a)};
    if (!plane.isPossible() || sample_step * supportOf(plane, sample).on < promising * most)
    {
      continue;
    }
    const Support support = supportOf(plane, points);
    const double score = support.on - support.behind;
    if (score > most && support.isOfGround())
    {
      most = score;
      best = plane;
    }
  }
  return best;
}

std::optional<GroundPlane> refined(const std::optional<Plane>& drawn, const Points& points)
{
  if (!drawn)
  {
    return std::nullopt;
  }
  Plane plane = *drawn;
  double spread = 0;
  for (const double distance : {drawn_distance, drawn_distance, final_distance, final_distance})
  {
    plane = fitted(plane, points, distance, spread);
  }
  const Support support = supportOf(plane, points);
  const double share = support.on / totalWeight(points);
  if (!plane.isPossible() || spread < min_spread || share < min_share || !support.isOfGround())
  {
    return std::nullopt;
  }
  return GroundPlane{plane.normal, plane.height, share};
}
}  // namespace

double GroundPlane::inclination() const
{
  return std::acos(std::clamp(normal.z(), -1.0, 1.0));
}

double GroundPlane::roll() const
{
  return std::atan2(normal.y(), normal.z());
}

double GroundPlane::pitch() const
{
  return std::atan2(-normal.x(), std::hypot(normal.y(), normal.z()));
}

std::optional<GroundPlane> findGroundPlane(const std::vector<Eigen::Vector3f>& points,
                                           GroundSide side)
{
  const Points near = thinned(points);
  if (near.size() < min_cubes || (side == GroundSide::above && !areMostlyAbove(near)))
  {
    return std::nullopt;
  }
  return refined(drawPlane(near, side == GroundSide::below ? 1 : -1), near);
}
}  // namespace dyslam
