// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <optional>
#include <string>

namespace dyslam
{
/** Class of a box by the name that a 3D detector gives it, in upper or lower case: those of
 * objectClassFromString(), of nuScenes (`construction_vehicle`, or with its parents, as in
 * `vehicle.bus.rigid`), Waymo (`TYPE_VEHICLE` or `Vehicle`) and Autoware (`BICYCLE`).
 * \return unknown for other names; nothing for things that cannot move, such as `traffic_cone` */
[[nodiscard]] std::optional<ObjectClass> classFromDetector(const std::string& name);
}  // namespace dyslam
