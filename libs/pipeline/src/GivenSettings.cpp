// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/SharedFiles.h>
#include <dyslam/pipeline/GivenSettings.h>

#include <filesystem>

namespace dyslam
{
namespace
{
void apply(const std::vector<std::string>& assignments, Config& config)
{
  for (const std::string& assignment : assignments)
  {
    config.set(assignment);
  }
}
}  // namespace

Config GivenSettings::merged() const
{
  Config config = ini;
  apply(assignments, config);
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
  ChosenSettings chosen = settingsFor(sensor, given.ini, name);
  apply(given.assignments, chosen.config);
  return chosen;
}
}  // namespace dyslam
