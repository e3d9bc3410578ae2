// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/BoxFitting.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace
{
struct Interval
{
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double x)
  {
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/** Closeness criterion: sum over points of 1 / (distance to the nearest side). */
double closeness(const std::vector<Eigen::Vector2d>& points, double yaw)
{
  constexpr double min_distance = 0.03;  // range noise [m]
  const Eigen::Vector2d u(std::cos(yaw), std::sin(yaw));
  const Eigen::Vector2d v(-u.y(), u.x());
  Interval along;
  Interval across;
  for (const Eigen::Vector2d& p : points)
  {
    along.add(u.dot(p));
    across.add(v.dot(p));
  }
  double sum = 0;
  for (const Eigen::Vector2d& p : points)
  {
    const double a = std::min(u.dot(p) - along.low, along.high - u.dot(p));
    const double b = std::min(v.dot(p) - across.low, across.high - v.dot(p));
    sum += 1 / std::max(min_distance, std::min(a, b));
  }
  return sum;
}

bool within(double x, double low, double high)
{
  return x >= low && x <= high;
}
}  // namespace

Box fitLShape(const std::vector<Eigen::Vector3f>& points, double yaw_step)
{
  constexpr std::size_t max_points = 200;
  std::vector<Eigen::Vector2d> sampled;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / max_points);
  for (std::size_t i = 0; i < points.size(); i += stride)
  {
    sampled.emplace_back(points[i].head<2>().cast<double>());
  }
  double best_yaw = 0;
  double best = -1;
  for (double yaw = 0; yaw < M_PI / 2; yaw += yaw_step)
  {
    const double value = closeness(sampled, yaw);
    if (value > best)
    {
      best = value;
      best_yaw = yaw;
    }
  }
  const Eigen::Vector2d u(std::cos(best_yaw), std::sin(best_yaw));
  const Eigen::Vector2d v(-u.y(), u.x());
  Interval along;
  Interval across;
  Interval up;
  for (const Eigen::Vector3f& p : points)
  {
    along.add(u.dot(p.head<2>().cast<double>()));
    across.add(v.dot(p.head<2>().cast<double>()));
    up.add(static_cast<double>(p.z()));
  }
  Box box;
  if (points.empty())
  {
    box.size.setZero();
    return box;
  }
  box.centre.head<2>() = 0.5 * (along.low + along.high) * u + 0.5 * (across.low + across.high) * v;
  box.centre.z() = 0.5 * (up.low + up.high);
  box.size = {along.high - along.low, across.high - across.low, up.high - up.low};
  box.yaw = best_yaw;
  if (box.size.y() > box.size.x())
  {
    std::swap(box.size.x(), box.size.y());
    box.yaw = best_yaw - M_PI / 2;
  }
  box.size = box.size.cwiseMax(0.05);
  return box;
}

ObjectClass classifyBySize(const Eigen::Vector3d& size)
{
  const double length = size.x();
  const double width = size.y();
  const double height = size.z();
  if (length > 7 || (height > 2.6 && length > 2.5))
  {
    return ObjectClass::truck;
  }
  if (length > 2.3 || width > 1.3)
  {
    return height < 2.6 ? ObjectClass::car : ObjectClass::truck;
  }
  if (within(length, 1.2, 2.3) && width <= 1.2 && within(height, 0.9, 2.2))
  {
    return width < 1.0 ? ObjectClass::cyclist : ObjectClass::unknown;
  }
  if (length < 1.2 && within(height, 0.8, 2.2))
  {
    return ObjectClass::pedestrian;
  }
  return ObjectClass::unknown;
}

namespace
{
constexpr double max_walking_speed = 3.5;  // includes a slow run [m/s]
}

ObjectClass refineClass(ObjectClass initial, const Eigen::Vector3d& size, double speed)
{
  const ObjectClass by_size = classifyBySize(size);
  if (by_size == ObjectClass::truck || by_size == ObjectClass::car)
  {
    return by_size;
  }
  if (initial == ObjectClass::pedestrian && speed > max_walking_speed)
  {
    return ObjectClass::cyclist;
  }
  return initial;
}

ObjectClass refinePerson(ObjectClass initial, const Eigen::Vector3d& size, double speed)
{
  constexpr double min_riding_speed = 2;  // [m/s]
  constexpr double longest_person = 1.2;  // [m]
  const bool slow_rider = initial == ObjectClass::cyclist && speed < min_riding_speed;
  const bool part = initial == ObjectClass::unknown && size.head<2>().maxCoeff() < longest_person &&
                    speed < max_walking_speed;
  return slow_rider || part ? ObjectClass::pedestrian : initial;
}

namespace
{
/** Whether a vehicle is a truck or a bus. \param size along and across the heading, and height [m]
 */
bool isHeavyVehicle(const Eigen::Vector3d& size)
{
  constexpr double max_width_of_vans = 2.25;  // [m]
  constexpr double max_height_of_cars = 1.7;  // excludes cars with too wide boxes [m]
  constexpr double max_height_of_vans = 2.6;  // [m]
  return size.z() > max_height_of_vans ||
         (size.z() > max_height_of_cars && size.y() > max_width_of_vans);
}
}  // namespace

ObjectClass refineVehicle(ObjectClass initial, const Eigen::Vector3d& size)
{
  constexpr double max_width = 3.2;  // trucks with their mirrors [m]
  if (size.y() > max_width)
  {
    return ObjectClass::unknown;
  }
  return isHeavyVehicle(size) ? ObjectClass::truck : initial;
}

Eigen::Vector3d leastSize(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
    case ObjectClass::van:
      return {4, 1.7, 1.4};
    case ObjectClass::truck:
    case ObjectClass::bus:
      return {8, 2, 0};  // 90 % of KITTI's trucks are 7.0 to 13.7 m long
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return {1.6, 0.6, 1.6};
    case ObjectClass::pedestrian:
      return {0.6, 0.6, 1.6};
    default:
      return Eigen::Vector3d::Zero();
  }
}

Box completeBox(const Box& visible, const Eigen::Vector3d& size)
{
  const Eigen::Vector2d u(std::cos(visible.yaw), std::sin(visible.yaw));
  const Eigen::Vector2d v(-u.y(), u.x());
  Box full = visible;
  full.size = visible.size.cwiseMax(size);
  // Each axis grows on its far side; on both sides if the sensor is beside the middle.
  for (int k = 0; k < 2; ++k)
  {
    const Eigen::Vector2d axis = k == 0 ? u : v;
    const double offset = axis.dot(visible.centre.head<2>());
    const double half = 0.5 * visible.size[k];
    const double side = std::clamp(half > 0 ? offset / half : 0.0, -1.0, 1.0);
    full.centre.head<2>() += 0.5 * (full.size[k] - visible.size[k]) * side * axis;
  }
  // The top stays in place: the ground filter and occlusion remove the lower part.
  full.centre.z() = visible.centre.z() + 0.5 * (visible.size.z() - full.size.z());
  return full;
}
}  // namespace dyslam
