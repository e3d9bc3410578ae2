// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/GivenSettings.h>
#include <dyslam/pipeline/SensorSettings.h>

#include <future>
#include <string>

namespace dyslam
{
struct SlamRunSettings;

/** The sensor of a recording, and the settings that fit it. */
struct RecordingSettings
{
  RecordedSensor sensor;
  ChosenSettings chosen;
};

/** Recognises the sensor of a rawlog, read with `[input]` as given, and chooses its settings.
 * \throws UserError as recogniseSensor() and settingsFor(). */
[[nodiscard]] RecordingSettings settingsForRecording(const std::string& rawlog,
                                                     const GivenSettings& given);

/** Settings of a run: those for its recording, and the speed at which it begins. */
struct RunSettings : RecordingSettings
{
  std::string missing_times;  //!< RecordedSensor::missingTimes(); empty if there is nothing to say
  std::string start_speed;    //!< odometry.start_speed, if findStartSpeed() found one [m/s]
  std::future<void> loading;  //!< loadAhead(): keep it until the Pipeline is constructed

  /** What the recording shows of its sensor, missing times and the levelling; for the report. */
  [[nodiscard]] std::string aboutSensor() const;
};

/** Chooses the settings of a run, as `dyslam` does: settingsForRecording(), then the speed of a
 * recording that begins in motion. Loading what they need has begun.
 * \throws UserError for bad settings, and if the rawlog has no scan. */
[[nodiscard]] RunSettings chooseRunSettings(const std::string& rawlog, const GivenSettings& given);

/** Sets the config of a run, and what its report says about its settings. */
void setSettings(const RunSettings& chosen, SlamRunSettings& run);
}  // namespace dyslam
