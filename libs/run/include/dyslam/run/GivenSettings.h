// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>
#include <dyslam/run/SensorSettings.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Settings that a user gives for a run; all others are chosen to fit the sensor. */
struct GivenSettings
{
  std::string path;                      //!< path of the ini; empty without one
  Config ini;                            //!< content of the ini; empty without one
  std::vector<std::string> assignments;  //!< "section.key=value"; replace those of the ini

  /** The ini with the assignments. \throws UserError if an assignment is not section.key=value. */
  [[nodiscard]] Config merged() const;
};

/** Reads an ini for dyslam.
 * \param ini path, or name of a shipped one ("handheld" or "handheld.ini"); empty: none
 * \throws UserError if the ini is missing, cannot be read, or is for another program. */
[[nodiscard]] GivenSettings readGivenSettings(const std::string& ini,
                                              const std::vector<std::string>& assignments = {});

/** Settings for a sensor: settingsFor() with the given ini and assignments.
 *
 * With `recogniseSensor()`, this function, `findStartSpeed()` and `setStartSpeed()` a program that
 * has a rawlog or the first scans of a live sensor gets the settings with which `dyslam` runs.
 * \throws UserError if an assignment is not section.key=value, and as settingsFor(). */
[[nodiscard]] ChosenSettings settingsFor(const RecordedSensor& sensor, const GivenSettings& given);
}  // namespace dyslam
