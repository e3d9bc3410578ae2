// SPDX-License-Identifier: BSD-3-Clause
#include "DetectorClasses.h"

#include <dyslam/base/Printable.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::array<std::string_view, 5> immobile{"traffic_cone", "trafficcone", "barrier",
                                                   "static_object", "sign"};

constexpr std::array<std::pair<std::string_view, ObjectClass>, 6> further_names{
    {{"vehicle", ObjectClass::car},
     {"trailer", ObjectClass::truck},
     {"construction_vehicle", ObjectClass::truck},
     {"construction", ObjectClass::truck},  // nuScenes' vehicle.construction
     {"bicycle", ObjectClass::cyclist},
     {"human", ObjectClass::pedestrian}}};

ObjectClass classOfWord(const std::string& word)
{
  const auto found = std::find_if(further_names.begin(), further_names.end(),
                                  [&word](const auto& known) { return known.first == word; });
  return found != further_names.end() ? found->second : objectClassFromString(word);
}
}  // namespace

std::optional<ObjectClass> classFromDetector(const std::string& name)
{
  constexpr std::string_view waymo_prefix = "type_";
  std::string rest = lowered(name);
  if (rest.compare(0, waymo_prefix.size(), waymo_prefix) == 0)
  {
    rest.erase(0, waymo_prefix.size());
  }
  for (;;)  // from the last word of "vehicle.bus.rigid", the most special one, to the first
  {
    const auto dot = rest.rfind('.');
    const std::string word = dot == std::string::npos ? rest : rest.substr(dot + 1);
    if (std::find(immobile.begin(), immobile.end(), word) != immobile.end())
    {
      return std::nullopt;
    }
    const ObjectClass found = classOfWord(word);
    if (found != ObjectClass::unknown || dot == std::string::npos)
    {
      return found;
    }
    rest.resize(dot);
  }
}
}  // namespace dyslam
