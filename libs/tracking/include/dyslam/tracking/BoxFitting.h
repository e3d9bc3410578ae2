// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <vector>

namespace dyslam
{
// Boxes of partly visible objects, and classes by their size.

/** Upright box by L-shape fitting (Zhang et al., "Efficient L-shape fitting for vehicle detection
 * using laser scanners", 2017, closeness criterion), with the full height of the points. The yaw is
 * that of the longer side, in [-pi/2, pi/2). \param yaw_step step of the search [rad] */
[[nodiscard]] Box fitLShape(const std::vector<Eigen::Vector3f>& points, double yaw_step);

/** Class by the visible size [m] alone; the object may be larger. */
[[nodiscard]] ObjectClass classifyBySize(const Eigen::Vector3d& size);
/** Class by full size [m] and speed [m/s]: car or truck by size, cyclist for a pedestrian above 3.5
 * m/s, else `initial`. */
[[nodiscard]] ObjectClass refineClass(ObjectClass initial,
                                      const Eigen::Vector3d& size,
                                      double speed);

/** Class of an object that is no vehicle by its full size [m] and its usual speed [m/s]: a cyclist
 * below 2 m/s is a pedestrian, with a trolley or closely beside another one, and so is what has no
 * class, is smaller than 1.2 m and not faster than 3.5 m/s: a person who is partly hidden.
 * \param initial result for others */
[[nodiscard]] ObjectClass refinePerson(ObjectClass initial,
                                       const Eigen::Vector3d& size,
                                       double speed);

/** Class of a vehicle by its full size along and across its heading [m], and its height [m]: trucks
 * and buses are wider and higher than vans; a box wider than all of them is unknown. In KITTI's
 * tracking labels 99 % of the cars are at most 1.9 m wide, 95 % of the vans at most 2.2 m, and 95 %
 * of the trucks at least 2.2 m. \param initial result for other sizes */
[[nodiscard]] ObjectClass refineVehicle(ObjectClass initial, const Eigen::Vector3d& size);

/** Least length, width and height of an object of a class [m], of which only one side may be
 * visible; zero if unknown. */
[[nodiscard]] Eigen::Vector3d leastSize(ObjectClass object_class);

/** Enlarges a partly visible box to at least `size`. The sides of `visible` that face the sensor
 * (at the origin) stay in place; the occluded part is added behind them. */
[[nodiscard]] Box completeBox(const Box& visible, const Eigen::Vector3d& size);
}  // namespace dyslam
