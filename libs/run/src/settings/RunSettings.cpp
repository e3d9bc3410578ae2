// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/run/RunSettings.h>
#include <dyslam/run/SlamRunSettings.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
RecordingSettings settingsForRecording(const std::string& rawlog, const GivenSettings& given)
{
  RawlogSourceOptions input;
  load(input, given.merged(), "input");
  const RecordedSensor sensor = recogniseSensor(rawlog, input);
  return {settingsFor(sensor, given), sensor};
}

std::string RunSettings::aboutSensor() const
{
  const std::string start =
      start_speed.empty() ? "" : "begins at about " + start_speed + " m/s (odometry.start_speed)";
  std::string text = sensor.summary();
  for (const std::string& note : {missing_times, levelling_note, start})
  {
    text += (note.empty() ? "" : "; ") + note;
  }
  return text;
}

namespace
{
/** The result of `find` for the first scans of a rawlog; nothing if they cannot be read. */
template <typename Find>
auto inFirstScans(const std::string& rawlog,
                  const RawlogSourceOptions& input,
                  const Config& config,
                  const Find& find) -> decltype(find(NextScan(), config))
{
  StartOptions start;
  load(start, config, "start");
  if (!start.search)
  {
    return std::nullopt;
  }
  try
  {
    RawlogSource source(rawlog, input);
    return find([&] { return source.next(); }, config);
  }
  catch (const UserError&)
  {
    return std::nullopt;  // the run reports it
  }
}
/** Which weights are used, where a given name is that of shipped ones and of a file or folder, too;
 * a sentence for each. */
std::vector<std::string> notesOnWeights(const GivenSettings& given)
{
  const Config merged = given.merged();
  std::vector<std::string> notes;
  for (const std::string section : {"dyseg_network", "dylo"})
  {
    std::string note = sharedInsteadOf(merged.text(section, "weights").value_or(""), "models",
                                       ".safetensors", section + ".weights");
    if (!note.empty())
    {
      notes.push_back(std::move(note));
    }
  }
  return notes;
}
}  // namespace

std::optional<double> findStartSpeed(const std::string& rawlog,
                                     const RawlogSourceOptions& input,
                                     const Config& config)
{
  return inFirstScans(rawlog, input, config,
                      [](const NextScan& next, const Config& of_run)
                      { return findStartSpeed(next, of_run); });
}

std::optional<SpeedContradiction> findWheelContradiction(const std::string& rawlog,
                                                         const RawlogSourceOptions& input,
                                                         const Config& config)
{
  return inFirstScans(rawlog, input, config,
                      [](const NextScan& next, const Config& of_run)
                      { return findWheelContradiction(next, of_run); });
}

RunSettings chooseRunSettings(const std::string& rawlog, const GivenSettings& given)
{
  RunSettings settings;
  static_cast<RecordingSettings&>(settings) = settingsForRecording(rawlog, given);
  Config& config = settings.config;
  for (std::string& note : notesOnWeights(given))
  {
    settings.warnings.push_back(std::move(note));
  }
  settings.loading = loadAhead(config);
  settings.missing_times = settings.sensor.missingTimes(config);
  RawlogSourceOptions input;
  load(input, config, "input");
  auto speed = findStartSpeed(rawlog, input, config);
  if (const auto contradiction =
          speed ? std::nullopt : findWheelContradiction(rawlog, input, config))
  {
    const bool are_used = given.merged().has("motion_sensors", "wheel_odometry");
    settings.warnings.push_back(warningOf(*contradiction, are_used));
    if (!are_used)
    {
      config.set("motion_sensors.wheel_odometry=false");
      speed = findStartSpeed(rawlog, input, config);
    }
  }
  if (speed)
  {
    setStartSpeed(*speed, config);
    settings.start_speed = config.text("odometry", "start_speed").value();
  }
  return settings;
}

void setSettings(const RunSettings& chosen, SlamRunSettings& run)
{
  run.config = chosen.config;
  run.sensor = chosen.aboutSensor();
  run.warnings.insert(run.warnings.end(), chosen.warnings.begin(), chosen.warnings.end());
}
}  // namespace dyslam
