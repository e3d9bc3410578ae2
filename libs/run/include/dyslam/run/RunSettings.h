// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/GivenSettings.h>
#include <dyslam/run/SensorSettings.h>

#include <future>
#include <optional>
#include <string>

namespace dyslam
{
struct RawlogSourceOptions;
struct SlamRunSettings;
struct SpeedContradiction;

/** The settings that were chosen for a recording, with its sensor. */
struct RecordingSettings : ChosenSettings
{
  RecordedSensor sensor;
};

/** Recognises the sensor of a rawlog, read with `[input]` as given, and chooses its settings.
 * \throws UserError as recogniseSensor() and settingsFor(). */
[[nodiscard]] RecordingSettings settingsForRecording(const std::string& rawlog,
                                                     const GivenSettings& given);

/** Settings of a run: settings for its recording, and the speed at its start. */
struct RunSettings : RecordingSettings
{
  std::string missing_times;  //!< RecordedSensor::missingTimes(); empty if none are missing
  std::string start_speed;    //!< odometry.start_speed, if findStartSpeed() found one [m/s]
  std::future<void> loading;  //!< loadAhead(): keep it until the Pipeline is constructed

  /** Sensor of the recording, missing times, levelling and the start speed that was found as text,
   * for the report. */
  [[nodiscard]] std::string aboutSensor() const;
};

/** findStartSpeed() for the first scans of a rawlog. */
[[nodiscard]] std::optional<double> findStartSpeed(const std::string& rawlog,
                                                   const RawlogSourceOptions& input,
                                                   const Config& config);

/** findWheelContradiction() for the first scans of a rawlog. */
[[nodiscard]] std::optional<SpeedContradiction> findWheelContradiction(
    const std::string& rawlog, const RawlogSourceOptions& input, const Config& config);

/** Chooses the settings of a run, as `dyslam` does: settingsForRecording(), then the speed of a
 * recording that begins in motion; warns if wheels contradict it. Starts loading the networks that
 * they need.
 * \throws UserError for bad settings, and if the rawlog has no scan. */
[[nodiscard]] RunSettings chooseRunSettings(const std::string& rawlog, const GivenSettings& given);

/** Sets the config of a run and, for its report, the text about the sensor; adds the warnings about
 * the settings. */
void setSettings(const RunSettings& chosen, SlamRunSettings& run);
}  // namespace dyslam
