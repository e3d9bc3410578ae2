// SPDX-License-Identifier: BSD-3-Clause
#include "SavedRun.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <dyslam/base/PathSettings.h>
#include <dyslam/base/Version.h>

#include <filesystem>

#include "../FirstPass.h"
#include "ScanSum.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** \throws UserError if an output is requested that the run did not have from its first scan on. */
void requireHad(bool asked, bool had, const std::string& flag)
{
  if (asked && !had)
  {
    throw UserError(flag +
                    ": the run to resume was started without it; leave it out, or start anew");
  }
}
}  // namespace

SavedRun savedRunOf(const SlamRunSettings& settings,
                    const Config& config,
                    const ScanSum& scans,
                    double seconds)
{
  SavedRun run;
  run.version = DYSLAM_VERSION;
  run.rawlog = fs::absolute(settings.rawlog).lexically_normal().string();
  run.rawlog_grew = isGrowing(settings.rawlog);  // before the size: the last data come before
  run.rawlog_size = fs::file_size(settings.rawlog);
  run.settings = config.toIni();
  run.is_second_pass = isSecondPass(config, settings.output_folder);
  if (!settings.ini.empty())
  {
    run.inputs.push_back(absolutePath(settings.ini));
  }
  run.sensor = settings.sensor;
  run.warnings = settings.warnings;
  run.static_scans = settings.static_scans;
  run.labels = settings.labels;
  run.probabilities = settings.probabilities;
  run.scans = scans.scans();
  run.scans_checksum = scans.sum();
  run.seconds = seconds;
  run.first_pass_time = settings.first_pass_time;
  return run;
}

SlamRunSettings settingsOf(const SavedRun& saved, const SlamRunSettings& given)
{
  SlamRunSettings settings = given;
  settings.rawlog = given.rawlog.empty() ? saved.rawlog : given.rawlog;
  settings.config = Config::fromText(saved.settings, "the state's settings");
  settings.config.merge(given.config);
  settings.ini = saved.inputs.empty() ? "" : saved.inputs.front();
  settings.sensor = saved.sensor;
  settings.warnings = saved.warnings;
  requireHad(given.static_scans, saved.static_scans, "--static-scans");
  requireHad(given.labels, saved.labels, "--labels");
  requireHad(given.probabilities, saved.probabilities, "--probabilities");
  settings.static_scans = saved.static_scans;
  settings.labels = saved.labels;
  settings.probabilities = saved.probabilities;
  return settings;
}

void requireSameSettings(const SavedRun& saved, const Config& config)
{
  const Config had = Config::fromText(saved.settings, "the state's settings");
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      const std::string before = had.text(section, key).value_or("not there");
      if (!isSameSetting(section, key, value.text, before))
      {
        throw UserError(section + "." + key + " is " + value.text +
                        ", in the run to resume it is " + before +
                        "; leave out --config, --set and other options of the settings, or start "
                        "anew");
      }
    }
  }
}

}  // namespace dyslam
