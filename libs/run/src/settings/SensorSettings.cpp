// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Angle.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Printable.h>
#include <dyslam/core/Quantile.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/run/SensorSettings.h>

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
/** Number of full scans that are examined, and of scans that are read to find them. */
constexpr int examined_scans = 5;
constexpr int most_examined = 50;
/** Least number of returns of a full scan, as a share of the scan with most returns. */
constexpr double full_share = 0.5;
/** Rings of a scan are accepted if another full scan has this share of their number. */
constexpr double same_rings = 0.9;
/** Share of returns above a lidar with rings, which mostly sees the ground; more is suspicious. */
constexpr double max_share_above = 2.0 / 3;
/** If the ground is inclined, it is also measured in every fifth scan after the examined ones: the
 * vehicle pitches and rolls. */
constexpr int ground_step = 5;
/** Factor on the limits of the ring spacing beyond which an ini obviously does not fit. */
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

/** Whether the lidar spins and has many rings that are not separable: rings of an HDL-64E overlap
 * when corrected for the position of each laser. */
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

/** Shipped settings that fit a sensor, if there are any. */
std::optional<ShippedSettings> shippedFor(const ScanPattern& pattern)
{
  for (const std::string& path : sharedFiles("config_files", ".ini"))
  {
    if (readWhole(path).find("[sensor]") == std::string::npos)
    {
      continue;  // an ini for other programs, or for any sensor
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

/** Share of the returns above the lidar, along the vehicle's z axis. */
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

/** Collects properties of a sensor from its scans. Scans with few returns, as when a sensor starts,
 * are not used. */
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
  /** Least number of returns of a full scan, by the scans so far. */
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
  /** The full scan with most rings; without rings, the one with most returns. */
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
  std::size_t richest_ = 0;  //!< largest number of returns of a scan
  RecordedSensor sensor_;
  bool times_differ_ = false;  //!< the points of a scan have different times
  std::vector<double> stamps_;
};

/** Whether the lidar looks downwards about as far as upwards. A plane above a lidar that looks
 * mostly upwards may be a ceiling. */
bool wouldSeeGroundBelow(const ScanPattern& pattern)
{
  constexpr double same_angle = 0.9;
  return (pattern.hasRings() || isDenseRevolution(pattern)) &&
         -pattern.lowest >= same_angle * pattern.highest;
}

/** Sensor and ground by the first scans. */
class SensorExamination
{
 public:
  /** Adds a scan; of several lidars only the first one is examined. */
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

/** Sets roll and pitch of [input] to those of the ground if it is inclined, else to 0; does nothing
 * if input.level is false. */
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
    // The run reports damage after the first scan.
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
