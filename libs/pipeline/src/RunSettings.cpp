// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/RunSettings.h>
#include <dyslam/pipeline/SlamRun.h>
#include <dyslam/pipeline/StartSpeed.h>

namespace dyslam
{
RecordingSettings settingsForRecording(const std::string& rawlog, const GivenSettings& given)
{
  RawlogSourceOptions input;
  load(input, given.merged(), "input");
  RecordingSettings settings;
  settings.sensor = recogniseSensor(rawlog, input);
  settings.chosen = settingsFor(settings.sensor, given);
  return settings;
}

std::string RunSettings::aboutSensor() const
{
  std::string text = sensor.summary();
  for (const std::string& note : {missing_times, chosen.levelling_note})
  {
    text += (note.empty() ? "" : "; ") + note;
  }
  return text;
}

RunSettings chooseRunSettings(const std::string& rawlog, const GivenSettings& given)
{
  RunSettings settings;
  static_cast<RecordingSettings&>(settings) = settingsForRecording(rawlog, given);
  Config& config = settings.chosen.config;
  settings.loading = loadAhead(config);
  settings.missing_times = settings.sensor.missingTimes(config);
  RawlogSourceOptions input;
  load(input, config, "input");
  if (const auto speed = findStartSpeed(rawlog, input, config))
  {
    setStartSpeed(*speed, config);
    settings.start_speed = config.section("odometry").at("start_speed").text;
  }
  return settings;
}

void setSettings(const RunSettings& chosen, SlamRunSettings& run)
{
  run.config = chosen.chosen.config;
  run.sensor = chosen.aboutSensor();
  run.warnings = chosen.chosen.warnings;
}
}  // namespace dyslam
