// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Angle.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Printable.h>
#include <dyslam/core/Quantile.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/SensorSettings.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>

#include "RecordedGround.h"

namespace dyslam
{
namespace
{
/** Full scans that are examined, and scans among which these are looked for. */
constexpr int examined_scans = 5;
constexpr int most_examined = 50;
/** A scan is full if it has this share of the returns of the richest one. */
constexpr double full_share = 0.5;
/** Rings are those of the sensor if another full scan has this share of them. */
constexpr double same_rings = 0.9;
/** A lidar with rings sees mostly the ground; more returns than this above it are suspicious. */
constexpr double max_share_above = 2.0 / 3;
/** Where the ground is inclined, it is measured in every fifth scan after those, too: the vehicle
 * pitches and rolls. */
constexpr int ground_step = 5;
/** Ring spacings outside the limits by this factor are an obvious mismatch. */
constexpr double plain_mismatch = 1.2;

std::string fixed(double value, int decimals)
{
  const double scale = std::pow(10, decimals);
  value = std::abs(value * scale) < 0.5 ? 0 : value;  // not -0.0
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

/** An angle in degrees. */
std::string degrees(double radians, int decimals)
{
  return fixed(degrees_per_radian * radians, decimals);
}

bool turnsFully(const ScanPattern& pattern)
{
  return degrees_per_radian * pattern.azimuth_extent > 359;
}

/** A lidar that spins with many rings, even if they cannot be told apart: those of an HDL-64E,
 * corrected for the position of each laser, overlap. */
bool isDenseRevolution(const ScanPattern& pattern)
{
  constexpr std::size_t min_returns = 50000;
  return !pattern.hasRings() && turnsFully(pattern) && pattern.returns >= min_returns;
}

std::string ringsOf(const ScanPattern& pattern)
{
  if (pattern.hasRings())
  {
    return std::to_string(pattern.rings.size()) + " rings, " + degrees(pattern.ring_spacing, 1) +
           " deg apart";
  }
  return (isDenseRevolution(pattern) ? "rings not separable (no ring numbers), " : "no rings, ") +
         std::to_string(pattern.returns) + " points a scan";
}

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

/** The shipped settings for such a sensor, if there are any. */
std::optional<ShippedSettings> shippedFor(const ScanPattern& pattern)
{
  for (const std::string& path : sharedFiles("config_files", ".ini"))
  {
    if (readWhole(path).find("[sensor]") == std::string::npos)
    {
      continue;  // for other programs, or for any sensor
    }
    const Config config = Config::fromFile(path);
    const SensorOptions options = sensorOptionsOf(config);
    if (options.automatic && fits(options, pattern, 1))
    {
      return ShippedSettings{std::filesystem::path(path).filename().string(), config};
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

/** Share of the returns that are above the lidar, with the axes of the vehicle. */
double shareAbove(const Scan& scan)
{
  const Eigen::Vector3f up = scan.T_vehicle_lidar.linear().row(2).cast<float>();
  std::size_t returns = 0;
  std::size_t above = 0;
  for (const Eigen::Vector3f& p : scan.points)
  {
    returns += isReturn(p) ? 1U : 0U;
    above += isReturn(p) && up.dot(p) > 0 ? 1U : 0U;
  }
  return returns > 0 ? static_cast<double>(above) / static_cast<double>(returns) : 0;
}

/** Collects what scans show of their sensor. Scans with few returns, as at the start of a sensor,
 * show little and do not count. */
class ExaminedScans
{
 public:
  void add(const Scan& scan)
  {
    shown_.push_back({measureScanPattern(scan), shareAbove(scan)});
    richest_ = std::max(richest_, shown_.back().pattern.returns);
    sensor_.has_times = sensor_.has_times || !scan.time.empty();
    times_differ_ = times_differ_ || shown_.back().pattern.point_times;
    stamps_.push_back(scan.stamp);
  }
  [[nodiscard]] bool empty() const { return stamps_.empty(); }
  /** Of a full scan, as far as is known. */
  [[nodiscard]] std::size_t minReturns() const
  {
    return static_cast<std::size_t>(std::ceil(full_share * static_cast<double>(richest_)));
  }
  [[nodiscard]] bool areEnough() const
  {
    const auto full =
        std::count_if(shown_.begin(), shown_.end(), [this](const Shown& s) { return isFull(s); });
    return full >= examined_scans || shown_.size() >= most_examined;
  }
  [[nodiscard]] RecordedSensor sensor() const
  {
    std::vector<double> periods;
    for (std::size_t i = 1; i < stamps_.size(); ++i)
    {
      periods.push_back(stamps_[i] - stamps_[i - 1]);
    }
    RecordedSensor sensor = sensor_;
    const Shown best = clearest();
    sensor.pattern = best.pattern;
    sensor.share_above = best.share_above;
    sensor.scans = shown_.size();
    sensor.equal_times = sensor.has_times && !times_differ_;
    sensor.period = periods.empty() ? 0 : upperMedian(periods);
    return sensor;
  }

 private:
  struct Shown
  {
    ScanPattern pattern;
    double share_above = 0;
  };

  [[nodiscard]] bool isFull(const Shown& s) const
  {
    return s.pattern.returns > 0 && s.pattern.returns >= minReturns();
  }
  /** Whether another full scan shows about as many rings, unless there is none. */
  [[nodiscard]] bool isConfirmed(const Shown& s) const
  {
    std::size_t others = 0;
    const double least = same_rings * static_cast<double>(s.pattern.rings.size());
    for (const Shown& other : shown_)
    {
      if (&other != &s && isFull(other))
      {
        ++others;
        if (static_cast<double>(other.pattern.rings.size()) >= least)
        {
          return true;
        }
      }
    }
    return others == 0;
  }
  /** Of the full scans the one with most rings, else with most returns. */
  [[nodiscard]] Shown clearest() const
  {
    Shown best;
    for (const Shown& s : shown_)
    {
      const bool better = s.pattern.rings.size() > best.pattern.rings.size() ||
                          (!best.pattern.hasRings() && s.pattern.returns > best.pattern.returns);
      if (better && isFull(s) && isConfirmed(s))
      {
        best = s;
      }
    }
    return best;
  }

  std::vector<Shown> shown_;
  std::size_t richest_ = 0;  //!< returns
  RecordedSensor sensor_;
  bool times_differ_ = false;  //!< those of the points of a scan
  std::vector<double> stamps_;
};

/** A lidar that looks downwards about as far as upwards. What is above one that looks mostly
 * upwards may be a ceiling. */
bool wouldSeeGroundBelow(const ScanPattern& pattern)
{
  constexpr double same_angle = 0.9;
  return (pattern.hasRings() || isDenseRevolution(pattern)) &&
         -pattern.lowest >= same_angle * pattern.highest;
}

/** What the first scans show of sensor and ground. */
class SensorExamination
{
 public:
  /** Of several lidars the first is examined. */
  void add(const Scan& scan)
  {
    if (!scan.parts.empty())
    {
      add(ownScan(scan));
      return;
    }
    ++added_;
    const bool only_ground = scans_.areEnough();
    if (!only_ground)
    {
      scans_.add(scan);
    }
    const auto returns =
        static_cast<std::size_t>(std::count_if(scan.points.begin(), scan.points.end(), isReturn));
    if (returns > 0 && returns >= scans_.minReturns() &&
        (!only_ground || added_ % ground_step == 0))
    {
      ground_.add(scan, returns);
    }
  }
  [[nodiscard]] bool empty() const { return scans_.empty(); }
  [[nodiscard]] bool isDone() const
  {
    return scans_.areEnough() && (added_ >= most_examined || !isInclined(sensor().ground));
  }
  [[nodiscard]] RecordedSensor sensor() const
  {
    RecordedSensor sensor = scans_.sensor();
    sensor.ground = ground_.plane(GroundSide::below, scans_.minReturns());
    if (!sensor.ground && wouldSeeGroundBelow(sensor.pattern))
    {
      sensor.ground = ground_.plane(GroundSide::above, scans_.minReturns());
    }
    return sensor;
  }

 private:
  ExaminedScans scans_;
  RecordedGround ground_;
  int added_ = 0;
};

bool hasNoReturns(const RecordedSensor& sensor)
{
  return sensor.scans > 0 && sensor.pattern.returns == 0;
}

/** "the ground is inclined by 20.1 deg in the vehicle frame (roll 0.2 deg, pitch 20.1 deg)". */
std::string inclinationOf(const GroundPlane& ground)
{
  return "the ground is inclined by " + degrees(ground.inclination(), 1) +
         " deg in the vehicle frame of the recording (roll " + degrees(ground.roll(), 1) +
         " deg, pitch " + degrees(ground.pitch(), 1) + " deg)";
}

/** The ground as the levelled vehicle sees it. */
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

/** What is doubtful about the recording, one sentence each.
 * \param levelling by angles of the user */
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
            " %) lie above the lidar: is its z axis down? (--sensor-pose of the converters)"};
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

/** \throws UserError for angles of the user that levelling would replace. A whole ini, as
 * effective.ini, has those of its recording beside `level`. */
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

/** Sets roll and pitch of [input] to those of the ground if it is inclined, else to 0; not if its
 * `level` is false. */
void levelVehicleFrame(const RecordedSensor& sensor,
                       const Config& given,
                       const Config& assigned,
                       ChosenSettings& chosen)
{
  RawlogSourceOptions input;
  load(input, chosen.config, "input");
  if (input.level)
  {
    requireNoAngles(given, true);
    requireNoAngles(assigned, false);
    const bool inclined = isInclined(sensor.ground);
    const auto set = [&chosen](const std::string& key, const std::string& value)
    { chosen.config.set("input." + key + "=" + value); };
    if (inclined || input.roll != 0 || input.pitch != 0)
    {
      set("level", "true");  // beside the angles, as a whole ini has it
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

std::string RecordedSensor::summary() const
{
  std::string text = ringsOf(pattern) + ", " + degrees(pattern.lowest, 1) + " to " +
                     degrees(pattern.highest, 1) + " deg";
  if (!turnsFully(pattern))
  {
    text += ", " + degrees(pattern.azimuth_extent, 0) + " deg wide";
  }
  text += ", to " + fixed(pattern.max_range, 0) + " m";
  return text + (period > 0 ? ", " + fixed(1 / period, 1) + " Hz" : "");
}

std::string RecordedSensor::missingTimes(const std::string& deskew) const
{
  const std::string spins = "turns clockwise and begins each scan straight behind";
  if (equal_times && (deskew == "auto" || deskew == "time"))
  {
    return "all points of a scan have the same time: the scans count as deskewed; if they are "
           "not: a recording with the times of the points" +
           (turnsFully(pattern) ? ", or, for a lidar that " + spins + ", preprocess.deskew=azimuth"
                                : std::string());
  }
  if (has_times)
  {
    return {};
  }
  if (pattern.firing_order && (deskew == "auto" || deskew == "time"))
  {
    return "the points have no times: scans are deskewed by the order of their points, which are "
           "stored as they were fired; for scans deskewed before: preprocess.deskew=none";
  }
  if (deskew == "auto" || deskew == "azimuth")
  {
    return "the points have no times: scans are deskewed by azimuth, which is right for a lidar "
           "that " +
           spins + ", as KITTI's; for any other, and for scans deskewed before: " +
           "preprocess.deskew=none";
  }
  std::string text =
      "the points have no times: scans are not deskewed, so that fast motion blurs them";
  if (deskew == "none")
  {
    return text;
  }
  text += "; better: a recording with the times of the points";
  return turnsFully(pattern)
             ? text + ", or, for a lidar that " + spins + ", preprocess.deskew=azimuth"
             : text;
}

std::string RecordedSensor::missingTimes(const Config& config) const
{
  return missingTimes(
      config.has("preprocess", "deskew") ? config.section("preprocess").at("deskew").text : "auto");
}

RecordedSensor recogniseSensor(const std::string& rawlog, const RawlogSourceOptions& input)
{
  RawlogSourceOptions options = input;
  options.merge_further = false;
  options.roll = 0;
  options.pitch = 0;
  options.only_first_n =
      input.only_first_n > 0 ? std::min(input.only_first_n, most_examined) : most_examined;
  RawlogSource source(rawlog, options);
  SensorExamination examination;
  try
  {
    while (!examination.isDone())
    {
      const auto frame = source.next();
      if (!frame)
      {
        break;
      }
      examination.add(frame->scan);
    }
  }
  catch (const UserError&)
  {
    if (examination.empty())
    {
      throw;
    }
    // Damage after the first scan is reported by the run.
  }
  return examination.sensor();
}

RecordedSensor recogniseSensor(const std::vector<Frame>& frames)
{
  if (frames.empty())
  {
    throw std::invalid_argument("recogniseSensor: no frames");
  }
  SensorExamination examination;
  for (std::size_t i = 0; i < frames.size() && !examination.isDone(); ++i)
  {
    examination.add(frames[i].scan);
  }
  return examination.sensor();
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
  // Rings that cannot be separated are close to each other.
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
      throw UserError(
          "the shipped settings are not found; set DYSLAM_SHARE to the folder share/dyslam");
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
  Config assigned;
  for (const std::string& assignment : assignments)
  {
    assigned.set(assignment);
  }
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
}  // namespace dyslam
