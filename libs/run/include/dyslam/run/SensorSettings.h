// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Angle.h>
#include <dyslam/core/Config.h>
#include <dyslam/core/Frame.h>
#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/ScanPattern.h>
#include <dyslam/io/Levelling.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
struct RawlogSourceOptions;

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

/** Properties of a lidar, measured from the first scans of a recording that have many returns. */
struct RecordedSensor
{
  ScanPattern pattern;     //!< pattern of the scan with most rings
  double share_above = 0;  //!< share of its returns above the lidar, along the vehicle's z
  /** Ground plane in axes of the recording's vehicle frame, origin at the lidar; nothing if the
   * scans show no ground or do not agree. */
  std::optional<GroundPlane> ground;
  double period = 0;         //!< median time between scans [s]; 0 for a single scan
  bool has_times = false;    //!< points have times, even if all the same (deskewed before)
  bool equal_times = false;  //!< points have times, but the same for all points of a scan
  std::size_t scans = 0;     //!< number of scans examined

  /** Text such as "16 rings, 2.0 deg apart, -15.0 to 15.0 deg, to 98 m, 10.0 Hz". */
  [[nodiscard]] std::string summary() const;
  /** Sentence about missing or equal point times, the consequence and the remedy; empty if times
   * are not missing. \param deskew value of preprocess.deskew */
  [[nodiscard]] std::string missingTimes(const std::string& deskew) const;
  /** missingTimes() with preprocess.deskew of a run's config. */
  [[nodiscard]] std::string missingTimes(const Config& config) const;
};

/** Recognises the sensor from the first scans of a rawlog: up to fifty, until five of them have
 * many returns; fifty if the ground is inclined. The scans are in the vehicle frame of the
 * recording: roll and pitch of the options are ignored. \throws UserError if there is no scan. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::string& rawlog,
                                             const RawlogSourceOptions& input);

/** Recognises the sensor from the first scans of a live sensor; five with many returns suffice.
 * \param frames only `scan` is read \throws std::invalid_argument without a frame. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::vector<Frame>& frames);

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
}  // namespace dyslam
