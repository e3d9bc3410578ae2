// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace dyslam
{
namespace
{
using Eigen::Vector2d;

/** Convex polygon with room for a rectangle cut by four lines. */
struct Polygon
{
  std::array<Vector2d, 16> corner;
  std::size_t size = 0;

  void add(const Vector2d& p)
  {
    if (size < corner.size())
    {
      corner[size++] = p;
    }
  }
};

double cross(const Vector2d& a, const Vector2d& b)
{
  return a.x() * b.y() - a.y() * b.x();
}

/** Corners counter-clockwise, relative to `origin`. */
Polygon footprint(const Box& box, const Vector2d& origin)
{
  const Vector2d forward = 0.5 * box.size.x() * Vector2d(std::cos(box.yaw), std::sin(box.yaw));
  const Vector2d left = 0.5 * box.size.y() * Vector2d(-std::sin(box.yaw), std::cos(box.yaw));
  const Vector2d centre = box.centre.head<2>() - origin;
  Polygon polygon;
  polygon.add(centre + forward + left);
  polygon.add(centre - forward + left);
  polygon.add(centre - forward - left);
  polygon.add(centre + forward - left);
  return polygon;
}

double area(const Polygon& polygon)
{
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size; ++i)
  {
    twice += cross(polygon.corner[i], polygon.corner[(i + 1) % polygon.size]);
  }
  return 0.5 * twice;
}

/** Part of `polygon` to the left of the line from a to b. */
Polygon leftOf(const Polygon& polygon, const Vector2d& a, const Vector2d& b)
{
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size; ++i)
  {
    const Vector2d& p = polygon.corner[i];
    const Vector2d& q = polygon.corner[(i + 1) % polygon.size];
    const double p_side = cross(b - a, p - a);
    const double q_side = cross(b - a, q - a);
    if (p_side >= 0)
    {
      kept.add(p);
    }
    if ((p_side > 0 && q_side < 0) || (p_side < 0 && q_side > 0))
    {
      kept.add(p + (q - p) * (p_side / (p_side - q_side)));
    }
  }
  return kept;
}

double intersectionArea(const Polygon& a, const Polygon& b)
{
  Polygon common = a;
  for (std::size_t i = 0; i < b.size && common.size > 0; ++i)
  {
    common = leftOf(common, b.corner[i], b.corner[(i + 1) % b.size]);
  }
  return std::max(0.0, area(common));
}

/** Area of the convex hull of two rectangles (Andrew's monotone chain). */
double hullArea(const Polygon& a, const Polygon& b)
{
  std::array<Vector2d, 8> points;
  std::copy_n(a.corner.begin(), 4, points.begin());
  std::copy_n(b.corner.begin(), 4, points.begin() + 4);
  std::sort(points.begin(), points.end(),
            [](const Vector2d& p, const Vector2d& q)
            { return p.x() < q.x() || (p.x() == q.x() && p.y() < q.y()); });
  std::array<Vector2d, 17> chain;
  std::size_t size = 0;
  const auto push = [&](const Vector2d& p, std::size_t floor)
  {
    while (size >= floor + 2 && cross(chain[size - 1] - chain[size - 2], p - chain[size - 2]) <= 0)
    {
      --size;
    }
    chain[size++] = p;
  };
  for (const Vector2d& p : points)
  {
    push(p, 0);
  }
  const std::size_t lower = size - 1;
  for (std::size_t i = points.size() - 1; i-- > 0;)
  {
    push(points[i], lower);
  }
  double twice = 0;
  for (std::size_t i = 0; i + 1 < size; ++i)
  {
    twice += cross(chain[i], chain[i + 1]);
  }
  return 0.5 * twice;
}

bool hasExtent(const Box& box)
{
  return box.centre.allFinite() && box.size.allFinite() && std::isfinite(box.yaw) &&
         box.size.minCoeff() > 0;
}

double commonHeight(const Box& a, const Box& b)
{
  const double top = std::min(a.centre.z() + 0.5 * a.size.z(), b.centre.z() + 0.5 * b.size.z());
  const double bottom = std::max(a.centre.z() - 0.5 * a.size.z(), b.centre.z() - 0.5 * b.size.z());
  return std::max(0.0, top - bottom);
}
}  // namespace

BoxOverlap boxOverlap(const Box& a, const Box& b)
{
  BoxOverlap overlap;
  if (!hasExtent(a) || !hasExtent(b))
  {
    return overlap;
  }
  const Vector2d origin = a.centre.head<2>();
  const Polygon pa = footprint(a, origin);
  const Polygon pb = footprint(b, origin);
  const double common = intersectionArea(pa, pb);
  const double area_a = a.size.x() * a.size.y();
  const double area_b = b.size.x() * b.size.y();
  overlap.ground_iou = common / (area_a + area_b - common);
  const double volume = common * commonHeight(a, b);
  const double both = a.size.prod() + b.size.prod() - volume;
  overlap.iou = volume / both;
  const double top = std::max(a.centre.z() + 0.5 * a.size.z(), b.centre.z() + 0.5 * b.size.z());
  const double bottom = std::min(a.centre.z() - 0.5 * a.size.z(), b.centre.z() - 0.5 * b.size.z());
  const double hull = std::max(both, hullArea(pa, pb) * (top - bottom));
  overlap.giou = overlap.iou - (hull - both) / hull;
  return overlap;
}

double boxIou(const Box& a, const Box& b)
{
  const double reach = 0.5 * (a.size.head<2>().norm() + b.size.head<2>().norm());
  if (!((a.centre - b.centre).head<2>().squaredNorm() < reach * reach) || !hasExtent(a) ||
      !hasExtent(b))
  {
    return 0;
  }
  const double height = commonHeight(a, b);
  if (height <= 0)
  {
    return 0;
  }
  const Vector2d origin = a.centre.head<2>();
  const double volume = height * intersectionArea(footprint(a, origin), footprint(b, origin));
  return volume / (a.size.prod() + b.size.prod() - volume);
}

Box transformed(const Box& box, const Pose& T)
{
  const Eigen::Vector3d forward =
      T.linear() * Eigen::Vector3d(std::cos(box.yaw), std::sin(box.yaw), 0);
  Box moved = box;
  moved.centre = T * box.centre;
  moved.yaw = std::atan2(forward.y(), forward.x());
  return moved;
}

Box transformedBack(const Box& moved, const Pose& T)
{
  const Eigen::Vector2d forward = T.linear().topLeftCorner<2, 2>().inverse() *
                                  Eigen::Vector2d(std::cos(moved.yaw), std::sin(moved.yaw));
  Box box = moved;
  box.centre = T.inverse() * moved.centre;
  box.yaw = std::atan2(forward.y(), forward.x());
  return box;
}
}  // namespace dyslam
