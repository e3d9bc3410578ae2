// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Options.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Describes an options struct within another one: prepends a prefix to every key, and the subject
 * to every help text. */
class PrefixedVisitor : public OptionsVisitor
{
 public:
  PrefixedVisitor(OptionsVisitor& visitor, std::string prefix, const std::string& about)
      : visitor_(visitor), prefix_(std::move(prefix)), about_(about + ": ")
  {
  }
  void real(const char* key, double& value, double min, double max, const char* help) override
  {
    visitor_.real((prefix_ + key).c_str(), value, min, max, (about_ + help).c_str());
  }
  void integer(const char* key, int& value, int min, int max, const char* help) override
  {
    visitor_.integer((prefix_ + key).c_str(), value, min, max, (about_ + help).c_str());
  }
  void flag(const char* key, bool& value, const char* help) override
  {
    visitor_.flag((prefix_ + key).c_str(), value, (about_ + help).c_str());
  }
  void text(const char* key, std::string& value, const char* help) override
  {
    visitor_.text((prefix_ + key).c_str(), value, (about_ + help).c_str());
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char* help) override
  {
    visitor_.word((prefix_ + key).c_str(), value, words, (about_ + help).c_str());
  }

 private:
  OptionsVisitor& visitor_;
  std::string prefix_;
  std::string about_;
};

// Options by class of object: members `vehicle`, `cyclist` and `pedestrian` of one type.

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
