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

/** Ini section `[sensor]`: which sensors the settings of an ini are for. An ini that has it is
 * complete; one without changes the settings that fit the recording. */
struct SensorOptions : Options
{
  bool automatic = false;  //!< select this ini automatically for such sensors
  RingsWanted rings = RingsWanted::any;
  double min_ring_spacing = 0;  //!< least median spacing of neighbouring rings [rad]
  /** Largest median spacing of neighbouring rings [rad]. */
  double max_ring_spacing = 40 * radians_per_degree;

  void describe(OptionsVisitor& visitor) override;
};

/** Properties of a lidar, measured from the first scans of a recording that have many returns. */
struct RecordedSensor
{
  ScanPattern pattern;     //!< of the scan that shows most rings
  double share_above = 0;  //!< of its returns: above the lidar, with the axes of the vehicle
  /** Axes of the recording's vehicle frame, origin at the lidar; nothing where the scans show no
   * ground or do not agree. */
  std::optional<GroundPlane> ground;
  double period = 0;         //!< between scans, median [s]; 0 for a single scan
  bool has_times = false;    //!< points have times, even if all the same (deskewed before)
  bool equal_times = false;  //!< ... which are the same for all points of a scan
  std::size_t scans = 0;     //!< looked at

  /** "16 rings, 2.0 deg apart, -15.0 to 15.0 deg, to 98 m, 10.0 Hz". */
  [[nodiscard]] std::string summary() const;
  /** Missing or equal point times, what follows from that and what can be done; empty if there is
   * nothing to say.
   * \param deskew value of preprocess.deskew */
  [[nodiscard]] std::string missingTimes(const std::string& deskew) const;
  /** The same with preprocess.deskew of a run's config. */
  [[nodiscard]] std::string missingTimes(const Config& config) const;
};

/** Reads a few scans: up to fifty, until five of them have many returns; fifty where the ground is
 * inclined. They are those of the recording's vehicle frame: roll and pitch of the options are
 * ignored. \throws UserError if there is none. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::string& rawlog,
                                             const RawlogSourceOptions& input);

/** The same from the first scans of a live sensor; five with many returns are enough.
 * \param frames `scan` of each is read \throws std::invalid_argument without a frame. */
[[nodiscard]] RecordedSensor recogniseSensor(const std::vector<Frame>& frames);

/** \param tolerance factor by which the spacing of the rings may be outside the limits. */
[[nodiscard]] bool fits(const SensorOptions& options, const ScanPattern& pattern, double tolerance);

struct ChosenSettings
{
  Config config;
  Levelling levelling;         //!< of input.roll_deg and input.pitch_deg
  std::string levelling_note;  //!< a sentence for the user, if the ground was inclined; else empty
  std::string source;          //!< the inis: "vlp16.ini", "vlp16.ini + my.ini"
  std::vector<std::string>
      warnings;  //!< settings that clearly do not fit, a recording to be checked; a sentence each

  /** Levelling::apply(), for a program that makes frames itself; RawlogSource and ScanDecoder do so
   * with the options of [input]. */
  void level(Frame& frame) const { levelling.apply(frame); }
};

/** The settings for a recording: those of an ini that names the sensors it is for, else the shipped
 * ones that fit the sensor, changed by those of the ini, then by single ones. With `level` of
 * [input], the default, its roll and pitch are those of the ground, if that is inclined in the
 * recording's vehicle frame, else 0.
 * \param given of the user's ini; empty without \param name of it; empty without
 * \param assignments "section.key=value"
 * \throws UserError for a shipped ini that cannot be read or is not found, and for an assignment
 * that is not section.key=value. */
[[nodiscard]] ChosenSettings settingsFor(const RecordedSensor& sensor,
                                         const Config& given,
                                         const std::string& name,
                                         const std::vector<std::string>& assignments = {});
}  // namespace dyslam
