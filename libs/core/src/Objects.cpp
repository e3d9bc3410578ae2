// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/core/Objects.h>

#include <array>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::array<std::pair<ObjectClass, const char*>, 8> names{
    {{ObjectClass::unknown, "Misc"},
     {ObjectClass::car, "Car"},
     {ObjectClass::van, "Van"},
     {ObjectClass::truck, "Truck"},
     {ObjectClass::bus, "Bus"},
     {ObjectClass::motorcyclist, "Motorcyclist"},
     {ObjectClass::cyclist, "Cyclist"},
     {ObjectClass::pedestrian, "Pedestrian"}}};
}  // namespace

std::string toString(ObjectClass object_class)
{
  for (const auto& [value, name] : names)
  {
    if (value == object_class)
    {
      return name;
    }
  }
  return "Misc";
}

ObjectClass objectClassFromString(const std::string& name)
{
  const std::string wanted = lowered(name);
  if (wanted == "person" || wanted == "person_sitting")
  {
    return ObjectClass::pedestrian;
  }
  // SUSTechPOINTS's own data have the third spelling.
  if (wanted == "motorcycle" || wanted == "motorcyclerider" || wanted == "motorcylerider" ||
      wanted == "motorcycle_rider")
  {
    return ObjectClass::motorcyclist;
  }
  if (wanted == "bicyclerider")
  {
    return ObjectClass::cyclist;
  }
  for (const auto& [value, known] : names)
  {
    if (lowered(known) == wanted)
    {
      return value;
    }
  }
  return ObjectClass::unknown;
}

bool isVehicle(ObjectClass object_class)
{
  return object_class == ObjectClass::car || object_class == ObjectClass::van ||
         object_class == ObjectClass::truck || object_class == ObjectClass::bus;
}
}  // namespace dyslam
