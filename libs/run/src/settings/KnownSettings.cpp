// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/run/KnownSettings.h>
#include <dyslam/run/SensorSettings.h>
#include <dyslam/run/SlamRun.h>

#include <algorithm>
#include <optional>

namespace dyslam
{
namespace
{
/** The settings of a run with those given, which ends before it begins. \throws UserError as the
 * constructor of SlamRun. */
Config effectiveOf(const Config& config)
{
  SlamRunSettings settings;
  settings.rawlog = "none.rawlog";  // is not opened
  settings.output_folder = "none";  // is not made
  settings.config = config;
  return SlamRun(settings).effective();  // stages and outputs load their sections, used or not
}
}  // namespace

Config defaultSettings()
{
  return effectiveOf({});
}

std::vector<std::string> sectionsOfRun()
{
  std::vector<std::string> names = defaultSettings().sectionNames();
  std::sort(names.begin(), names.end());
  return names;
}

void requireKnownNames(const Config& config)
{
  const Config known = defaultSettings();
  Config unknown;
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      if (!known.has(section, key))
      {
        unknown.set(section, key, value);
      }
    }
  }
  try
  {
    (void)effectiveOf(unknown);  // throws what the run would
  }
  catch (const UnknownSetting& error)
  {
    throw error.withSectionsOf(known);
  }
}

void requireValidSettings(const GivenSettings& given)
{
  requireKnownNames(given.merged());
  std::optional<UserError> first;
  for (const Config& possible : settingsForAnySensor(given.ini, given.assignments))
  {
    try
    {
      (void)effectiveOf(possible);
      return;
    }
    catch (const UserError& error)
    {
      if (!first)
      {
        first = error;
      }
    }
  }
  throw UserError(*first);
}
}  // namespace dyslam
