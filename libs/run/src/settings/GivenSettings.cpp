// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/SharedFiles.h>
#include <dyslam/run/GivenSettings.h>

#include <filesystem>

namespace dyslam
{
Config GivenSettings::merged() const
{
  Config config = ini;
  for (const std::string& assignment : assignments)
  {
    config.set(assignment);
  }
  return config;
}

GivenSettings readGivenSettings(const std::string& ini, const std::vector<std::string>& assignments)
{
  GivenSettings given;
  given.assignments = assignments;
  if (!ini.empty())
  {
    given.path = findGivenOrShared(ini, "config_files", ".ini", "", "dyslam");
    given.ini = Config::fromFile(given.path);
    given.ini.requireFor("dyslam");
  }
  return given;
}

ChosenSettings settingsFor(const RecordedSensor& sensor, const GivenSettings& given)
{
  const std::string name = std::filesystem::path(given.path).filename().string();
  return settingsFor(sensor, given.ini, name, given.assignments);
}
}  // namespace dyslam
