// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Objects.h>

namespace dyslam
{
// Options that exist once for vehicles, once for cyclists and once for pedestrians: members
// `vehicle`, `cyclist` and `pedestrian` of one type.

template <typename ByClass>
[[nodiscard]] const auto& optionsFor(const ByClass& options, ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::pedestrian:
      return options.pedestrian;
    case ObjectClass::cyclist:
    case ObjectClass::motorcyclist:
      return options.cyclist;
    default:
      return options.vehicle;
  }
}

template <typename ByClass>
void describeClasses(ByClass& options, OptionsVisitor& visitor)
{
  PrefixedVisitor vehicles(visitor, "vehicle_", "vehicles");
  options.vehicle.describe(vehicles);
  PrefixedVisitor cyclists(visitor, "cyclist_", "cyclists");
  options.cyclist.describe(cyclists);
  PrefixedVisitor pedestrians(visitor, "pedestrian_", "pedestrians");
  options.pedestrian.describe(pedestrians);
}
}  // namespace dyslam
