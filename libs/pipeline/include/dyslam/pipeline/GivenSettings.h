// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Config.h>
#include <dyslam/pipeline/SensorSettings.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Settings that a user gives for a run; the others are those that fit the sensor. */
struct GivenSettings
{
  std::string path;                      //!< of the ini; empty without
  Config ini;                            //!< empty without
  std::vector<std::string> assignments;  //!< "section.key=value", over those of the ini

  /** The ini with the assignments. \throws UserError if an assignment is not section.key=value. */
  [[nodiscard]] Config merged() const;
};

/** Reads an ini for dyslam.
 * \param ini path, or name of a shipped one ("handheld" or "handheld.ini"); empty: none
 * \throws UserError if it is not there, cannot be read, or is for another program. */
[[nodiscard]] GivenSettings readGivenSettings(const std::string& ini,
                                              const std::vector<std::string>& assignments = {});

/** The settings for a sensor: those of settingsFor() with the ini, under the assignments.
 *
 * `recogniseSensor()`, this, `findStartSpeed()` and `setStartSpeed()` give the settings with which
 * `dyslam` runs, to a program that has a rawlog or the first scans of a live sensor.
 * \throws UserError if an assignment is not section.key=value, and as settingsFor(). */
[[nodiscard]] ChosenSettings settingsFor(const RecordedSensor& sensor, const GivenSettings& given);
}  // namespace dyslam
