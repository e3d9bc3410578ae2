// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/SensorSettings.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr int examined_scans = 5;
/** Ring spacings outside the limits by this factor are an obvious mismatch. */
constexpr double plain_mismatch = 1.2;
constexpr double degrees_per_radian = 180 / 3.14159265358979323846;

std::string fixed(double value, int decimals)
{
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
  return (isDenseRevolution(pattern) ? "rings too close to tell apart, " : "no rings, ") +
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

double median(std::vector<double> values)
{
  if (values.empty())
  {
    return 0;
  }
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/** Collects what scans show of their sensor. */
class ExaminedScans
{
 public:
  void add(const Scan& scan)
  {
    const ScanPattern pattern = measureScanPattern(scan);
    const bool better = pattern.rings.size() > sensor_.pattern.rings.size() ||
                        (!sensor_.pattern.hasRings() && pattern.returns > sensor_.pattern.returns);
    sensor_.pattern = better ? pattern : sensor_.pattern;
    sensor_.has_times = sensor_.has_times || !scan.time.empty();
    stamps_.push_back(scan.stamp);
  }
  [[nodiscard]] bool empty() const { return stamps_.empty(); }
  [[nodiscard]] RecordedSensor sensor() const
  {
    std::vector<double> periods;
    for (std::size_t i = 1; i < stamps_.size(); ++i)
    {
      periods.push_back(stamps_[i] - stamps_[i - 1]);
    }
    RecordedSensor sensor = sensor_;
    sensor.period = median(periods);
    return sensor;
  }

 private:
  RecordedSensor sensor_;
  std::vector<double> stamps_;
};
}  // namespace

void SensorOptions::describe(OptionsVisitor& v)
{
  v.flag("automatic", automatic, "selected automatically for recordings of such sensors");
  v.choice("rings", rings,
           {{"any", RingsWanted::any}, {"yes", RingsWanted::yes}, {"no", RingsWanted::no}},
           "whether each laser's points lie on a ring of one elevation");
  v.degrees("min_ring_spacing_deg", min_ring_spacing, 0, 90, "between neighbouring rings");
  v.degrees("max_ring_spacing_deg", max_ring_spacing, 0, 90, "between neighbouring rings");
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
  if (has_times)
  {
    return {};
  }
  const std::string spins = "turns clockwise and begins each scan straight behind";
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
  options.only_first_n =
      input.only_first_n > 0 ? std::min(input.only_first_n, examined_scans) : examined_scans;
  RawlogSource source(rawlog, options);
  ExaminedScans scans;
  try
  {
    while (const auto frame = source.next())
    {
      scans.add(frame->scan);
    }
  }
  catch (const UserError&)
  {
    if (scans.empty())
    {
      throw;
    }
    // Damage after the first scan is reported by the run.
  }
  return scans.sensor();
}

RecordedSensor recogniseSensor(const std::vector<Frame>& frames)
{
  if (frames.empty())
  {
    throw std::invalid_argument("recogniseSensor: no frames");
  }
  ExaminedScans scans;
  for (std::size_t i = 0; i < frames.size() && i < examined_scans; ++i)
  {
    scans.add(frames[i].scan);
  }
  return scans.sensor();
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
                           const std::string& name)
{
  const std::optional<ShippedSettings> shipped = shippedFor(sensor.pattern);
  ChosenSettings chosen;
  if (given.section("sensor").empty())
  {
    chosen.config = shipped ? shipped->config : Config();
    chosen.config.merge(given);
    chosen.source = shipped ? shipped->name : "the defaults";
    chosen.source += name.empty() ? "" : " + " + name;
    if (!shipped)
    {
      chosen.warnings.emplace_back(
          "the shipped settings are not found; set DYSLAM_SHARE to the folder share/dyslam");
    }
    return chosen;
  }
  chosen.config = given;
  chosen.source = name;
  const SensorOptions wanted = sensorOptionsOf(given);
  if (!fits(wanted, sensor.pattern, plain_mismatch))
  {
    chosen.warnings.push_back(name + " is for " + wantedBy(wanted) + "; this recording has " +
                              ringsOf(sensor.pattern) +
                              (shipped ? "; without -c " + shipped->name + " is taken" : ""));
  }
  return chosen;
}
}  // namespace dyslam
