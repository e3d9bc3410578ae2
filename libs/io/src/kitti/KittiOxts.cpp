// SPDX-License-Identifier: BSD-3-Clause
#include "KittiOxts.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/KittiFiles.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "KittiCalibFinder.h"
#include "KittiScans.h"
#include "conversion/ConversionOutput.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** timestamps.txt of raw's oxts folder, or of the folder that its data are in; empty if there is
 * none. */
std::string oxtsTimestamps(const std::string& path)
{
  const fs::path folder = (fs::path(path) / "").lexically_normal().parent_path();
  std::vector<fs::path> candidates;
  if (fs::is_directory(folder))
  {
    candidates = {folder / "oxts" / "timestamps.txt", folder / "timestamps.txt"};
    if (folder.filename() == "data")
    {
      candidates.push_back(folder.parent_path() / "timestamps.txt");
    }
  }
  return firstExisting("", candidates);
}

/** Times of the readings [s]: their own if the scans have those of KITTI raw, else those of the
 * scans; NaN for readings without. */
std::vector<double> oxtsTimes(const std::string& path,
                              std::size_t readings,
                              KittiTimes of_scans,
                              const std::vector<KittiLayout::Entry>& entries)
{
  const std::string file = of_scans == KittiTimes::of_raw ? oxtsTimestamps(path) : "";
  if (!file.empty())
  {
    const std::vector<double> times = readKittiTimestamps(file);
    if (times.size() < readings)
    {
      throw UserError(file + ": has " + counted(times.size(), "time") + ", but there are " +
                      counted(readings, "reading") + " of oxts");
    }
    return times;
  }
  std::vector<double> times(readings, std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::size_t> lines = linesOfScans(entries, path, readings, "reading");
  for (std::size_t i = 0; i < lines.size(); ++i)
  {
    if (lines[i] < readings)
    {
      times[lines[i]] = entries[i].stamp;
    }
  }
  return times;
}
}  // namespace

std::string findOxts(const fs::path& folder,
                     const std::string& sequence,
                     const KittiConverterOptions& options)
{
  if (options.kind == KittiKind::kitti360)
  {
    return {};
  }
  std::vector<fs::path> candidates{folder / "oxts.txt"};
  if (!sequence.empty())
  {
    candidates.insert(candidates.begin(), folder / "oxts" / (sequence + ".txt"));
  }
  if (options.kind == KittiKind::raw)
  {
    candidates.push_back(folder / "oxts");
  }
  return firstExisting(options.oxts, candidates);
}

void readOxtsSamples(const std::string& path,
                     const Pose& T_velo_imu,
                     KittiTimes times,
                     const KittiConverterOptions& options,
                     KittiLayout& layout)
{
  const Pose T_vehicle_unit = poseFromOption("--sensor-pose", options.sensor_pose) * T_velo_imu;
  const std::vector<OxtsReading> readings = readOxts(path);
  const std::vector<double> stamps = oxtsTimes(path, readings.size(), times, layout.entries);
  for (std::size_t i = 0; i < readings.size(); ++i)
  {
    const OxtsReading& r = readings[i];
    if (std::isfinite(stamps[i]) && options.imu)
    {
      layout.imu.push_back({stamps[i], r.angular_velocity, r.acceleration, T_vehicle_unit});
    }
    if (std::isfinite(stamps[i]) && options.gnss)
    {
      layout.gnss.push_back({stamps[i],
                             {r.latitude, r.longitude, r.altitude},
                             r.position_accuracy,
                             r.position_accuracy,
                             T_vehicle_unit.translation()});
    }
  }
  const auto earlier = [](const auto& a, const auto& b) { return a.stamp < b.stamp; };
  std::stable_sort(layout.imu.begin(), layout.imu.end(), earlier);
  std::stable_sort(layout.gnss.begin(), layout.gnss.end(), earlier);
}
}  // namespace dyslam
