// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Config.h>
#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/ScanPattern.h>
#include <dyslam/io/Levelling.h>
#include <dyslam/run/RecordedSensor.h>

#include <string>
#include <vector>

namespace dyslam
{
enum class RingsWanted
{
  any,
  yes,
  no
};

/** Ini section `[sensor]`: the sensors that the settings of an ini are for. An ini with this
 * section is complete; an ini without it changes the settings that fit the recording. */
struct SensorOptions : Options
{
  bool automatic = false;  //!< select this ini automatically for these sensors
  RingsWanted rings = RingsWanted::any;
  double min_ring_spacing = 0;  //!< least median spacing of neighbouring rings [rad]
  /** Largest median spacing of neighbouring rings [rad]. */
  double max_ring_spacing = 40 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};

/** Whether the options include a sensor. \param tolerance factor on the limits of ring spacing */
[[nodiscard]] bool fits(const SensorOptions& options, const ScanPattern& pattern, double tolerance);

struct ChosenSettings
{
  Config config;
  Levelling levelling;         //!< rotation by input.roll_deg and input.pitch_deg
  std::string levelling_note;  //!< a sentence for the user, if the ground was inclined; else empty
  std::string source;          //!< names of the inis: "vlp16.ini", "vlp16.ini + my.ini"
  std::vector<std::string>
      warnings;  //!< sentences about settings that do not fit and doubts about the recording

  /** Calls Levelling::apply(), for a program that makes frames itself; RawlogSource and ScanDecoder
   * level frames by the options of [input]. */
  void level(Frame& frame) const { levelling.apply(frame); }
};

/** Settings for a recording: those of the user's ini if it has a section [sensor], else the shipped
 * settings that fit the sensor, changed by the user's ini; then changed by single assignments. With
 * `level` of [input] (the default), roll and pitch of [input] are set to those of the ground, if it
 * is inclined in the recording's vehicle frame, else to 0.
 * \param given content of the user's ini; empty without one \param name name of the ini
 * \param assignments "section.key=value"
 * \throws UserError for a shipped ini that cannot be read or is not found, and for an assignment
 * that is not section.key=value. */
[[nodiscard]] ChosenSettings settingsFor(const RecordedSensor& sensor,
                                         const Config& given,
                                         const std::string& name,
                                         const std::vector<std::string>& assignments = {});

/** Settings that settingsFor() may choose before the sensor is known, without levelling: first the
 * given ones over the defaults, then over the shipped settings of each sensor, if the user's ini
 * has no section [sensor]. \param given content of the user's ini; empty without one \param
 * assignments "section.key=value" \throws UserError as settingsFor(), but not if no settings are
 * shipped. */
[[nodiscard]] std::vector<Config> settingsForAnySensor(const Config& given,
                                                       const std::vector<std::string>& assignments);
}  // namespace dyslam
