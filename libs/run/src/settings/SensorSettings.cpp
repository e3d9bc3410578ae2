// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/run/SensorSettings.h>

#include <filesystem>
#include <optional>

#include "RecordedGround.h"
#include "SensorDescription.h"

namespace dyslam
{
namespace
{
/** Share of returns above a lidar with rings, which mostly sees the ground; more is suspicious. */
constexpr double max_share_above = 2.0 / 3;
/** Factor on the limits of the ring spacing beyond which an ini obviously does not fit. */
constexpr double plain_mismatch = 1.2;

SensorOptions sensorOptionsOf(const Config& config)
{
  SensorOptions options;
  load(options, config, "sensor");
  return options;
}

struct ShippedSettings
{
  std::string name;
  Config config;
};

/** Shipped settings that are selected automatically for the sensors of their section [sensor]. */
std::vector<ShippedSettings> automaticSettings()
{
  std::vector<ShippedSettings> settings;
  for (const std::string& path : sharedFiles("config_files", ".ini"))
  {
    if (readWhole(path).find("[sensor]") == std::string::npos)
    {
      continue;  // an ini for other programs, or for any sensor
    }
    const Config config = Config::fromFile(path);
    if (sensorOptionsOf(config).automatic)
    {
      settings.push_back({std::filesystem::path(path).filename().string(), config});
    }
  }
  return settings;
}

/** Shipped settings that fit a sensor, if there are any. */
std::optional<ShippedSettings> shippedFor(const ScanPattern& pattern)
{
  for (const ShippedSettings& shipped : automaticSettings())
  {
    if (fits(sensorOptionsOf(shipped.config), pattern, 1))
    {
      return shipped;
    }
  }
  return std::nullopt;
}

std::string wantedBy(const SensorOptions& options)
{
  if (options.rings == RingsWanted::no)
  {
    return "sensors without rings";
  }
  const std::string most = degrees(options.max_ring_spacing, 1) + " deg apart";
  return options.min_ring_spacing > 0
             ? "sensors with rings " + degrees(options.min_ring_spacing, 1) + " to " + most
             : "sensors with rings up to " + most;
}

bool hasNoReturns(const RecordedSensor& sensor)
{
  return sensor.scans > 0 && sensor.pattern.returns == 0;
}

/** "the ground is inclined by 20.1 deg in the vehicle frame (roll 0.2 deg, pitch 20.1 deg)" */
std::string inclinationOf(const GroundPlane& ground)
{
  return "the ground is inclined by " + degrees(ground.inclination(), 1) +
         " deg in the vehicle frame of the recording (roll " + degrees(ground.roll(), 1) +
         " deg, pitch " + degrees(ground.pitch(), 1) + " deg)";
}

/** The ground plane in the frame of the levelled vehicle. */
std::optional<GroundPlane> seenFrom(const Levelling& levelling,
                                    const std::optional<GroundPlane>& recorded)
{
  std::optional<GroundPlane> ground = recorded;
  if (ground)
  {
    ground->normal = levelling.T_level_recorded().linear() * ground->normal;
  }
  return ground;
}

/** Doubts about the recording, one sentence each.
 * \param levelling levelling by the user's angles */
std::vector<std::string> doubtsAbout(const RecordedSensor& sensor, const Levelling& levelling)
{
  const ScanPattern& pattern = sensor.pattern;
  if (hasNoReturns(sensor))
  {
    return {"no point of the first " + counted(sensor.scans, "scan") +
            " is a return: the sensor is not recognised, and the settings may not fit it; check "
            "the recording, or choose settings with -c"};
  }
  if (const auto ground = seenFrom(levelling, sensor.ground); isInclined(ground))
  {
    return {inclinationOf(*sensor.ground) +
            (levelling.isNone() ? " and not levelled, as input.level is false"
                                : "; after input.roll_deg and input.pitch_deg still by " +
                                      degrees(ground->inclination(), 1) + " deg") +
            ": segmentation and tracking are worse"};
  }
  if ((pattern.hasRings() || isDenseRevolution(pattern)) && sensor.share_above > max_share_above)
  {
    return {"most points (" + fixed(100 * sensor.share_above, 0) +
            " %) lie above the lidar: if its z axis points down, convert the recording with "
            "--sensor-pose '0 0 0 0 0 180'"};
  }
  return {};
}

/** Why an ini for other sensors does not fit; nothing if it does.
 * \param name of the ini */
std::optional<std::string> misfitOf(const Config& ini,
                                    const std::string& name,
                                    const RecordedSensor& sensor,
                                    const std::optional<ShippedSettings>& shipped)
{
  const SensorOptions wanted = sensorOptionsOf(ini);
  if (hasNoReturns(sensor) || fits(wanted, sensor.pattern, plain_mismatch))
  {
    return std::nullopt;
  }
  return name + " is for " + wantedBy(wanted) + "; this recording has " + ringsOf(sensor.pattern) +
         (shipped ? "; omit -c to use " + shipped->name : "");
}

/** \throws UserError for angles of the user that levelling would replace. A complete ini, such as
 * effective.ini, has the angles of its recording together with `level`. */
void requireNoAngles(const Config& config, bool may_have_level)
{
  for (const char* key : {"roll_deg", "pitch_deg"})
  {
    if (config.has("input", key) && !(may_have_level && config.has("input", "level")))
    {
      throw UserError(config.section("input").at(key).origin + ": input." + key +
                      " is set by input.level from the ground; add level = false");
    }
  }
}

/** \throws UserError if an assignment is not section.key=value. */
Config assignedBy(const std::vector<std::string>& assignments)
{
  Config assigned;
  for (const std::string& assignment : assignments)
  {
    assigned.set(assignment);
  }
  return assigned;
}

/** requireNoAngles() for an ini and assignments, unless `config` has input.level = false. */
void requireFittingAngles(const Config& config, const Config& given, const Config& assigned)
{
  RawlogSourceOptions input;
  load(input, config, "input");
  if (input.level)
  {
    requireNoAngles(given, true);
    requireNoAngles(assigned, false);
  }
}

/** Sets roll and pitch of [input] to those of the ground if it is inclined, else to 0; does nothing
 * if input.level is false. */
void levelVehicleFrame(const RecordedSensor& sensor,
                       const Config& given,
                       const Config& assigned,
                       ChosenSettings& chosen)
{
  RawlogSourceOptions input;
  load(input, chosen.config, "input");
  requireFittingAngles(chosen.config, given, assigned);
  if (input.level)
  {
    const bool inclined = isInclined(sensor.ground);
    const auto set = [&chosen](const std::string& key, const std::string& value)
    { chosen.config.set("input." + key + "=" + value); };
    if (inclined || input.roll != 0 || input.pitch != 0)
    {
      set("level", "true");  // together with the angles, as in effective.ini
      set("roll_deg", inclined ? degrees(sensor.ground->roll(), 2) : "0");
      set("pitch_deg", inclined ? degrees(sensor.ground->pitch(), 2) : "0");
      load(input, chosen.config, "input");
    }
    chosen.levelling_note = inclined ? inclinationOf(*sensor.ground) + ": levelled" : "";
  }
  chosen.levelling = input.levelling();
}
}  // namespace

void SensorOptions::describe(OptionsVisitor& v)
{
  v.flag("automatic", automatic,
         "select this ini automatically for recordings of the sensors it is for");
  v.choice("rings", rings,
           {{"any", RingsWanted::any}, {"yes", RingsWanted::yes}, {"no", RingsWanted::no}},
           "whether the sensors have rings: each laser's points at one elevation");
  v.degrees("min_ring_spacing_deg", min_ring_spacing, 0, 90,
            "least median spacing of neighbouring rings of the sensors [deg]");
  v.degrees("max_ring_spacing_deg", max_ring_spacing, 0, 90,
            "largest median spacing of neighbouring rings of the sensors [deg]");
}

bool fits(const SensorOptions& options, const ScanPattern& pattern, double tolerance)
{
  if (options.rings == RingsWanted::any && !pattern.hasRings())
  {
    return true;
  }
  const bool wants_rings = options.rings != RingsWanted::no;
  if (wants_rings != (pattern.hasRings() || isDenseRevolution(pattern)))
  {
    return false;
  }
  // Rings that are not separable are close to each other.
  const double spacing = pattern.hasRings() ? pattern.ring_spacing : 0;
  return !wants_rings || (spacing * tolerance >= options.min_ring_spacing &&
                          spacing < options.max_ring_spacing * tolerance);
}

ChosenSettings settingsFor(const RecordedSensor& sensor,
                           const Config& given,
                           const std::string& name,
                           const std::vector<std::string>& assignments)
{
  const std::optional<ShippedSettings> shipped = shippedFor(sensor.pattern);
  ChosenSettings chosen;
  std::optional<std::string> misfit;
  if (given.section("sensor").empty())
  {
    if (!shipped)
    {
      throw UserError("the shipped settings are not found in " + searchedFolders() +
                      "; set DYSLAM_SHARE to the folder share/dyslam");
    }
    chosen.config = shipped->config;
    chosen.config.merge(given);
    chosen.source = shipped->name + (name.empty() ? "" : " + " + name);
  }
  else
  {
    chosen.config = given;
    chosen.source = name;
    misfit = misfitOf(given, name, sensor, shipped);
  }
  const Config assigned = assignedBy(assignments);
  chosen.config.merge(assigned);
  levelVehicleFrame(sensor, given, assigned, chosen);
  if (chosen.levelling_note.empty())
  {
    chosen.warnings = doubtsAbout(sensor, chosen.levelling);
  }
  if (misfit)
  {
    chosen.warnings.push_back(*misfit);
  }
  return chosen;
}

std::vector<Config> settingsForAnySensor(const Config& given,
                                         const std::vector<std::string>& assignments)
{
  std::vector<Config> possible{given};
  if (given.section("sensor").empty())
  {
    for (const ShippedSettings& shipped : automaticSettings())
    {
      possible.push_back(shipped.config);
      possible.back().merge(given);
    }
  }
  const Config assigned = assignedBy(assignments);
  for (Config& config : possible)
  {
    config.merge(assigned);
  }
  requireFittingAngles(possible.front(), given, assigned);
  return possible;
}
}  // namespace dyslam
