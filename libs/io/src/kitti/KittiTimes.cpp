// SPDX-License-Identifier: BSD-3-Clause
#include "KittiTimes.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/PointTimeFiles.h>

#include <cmath>
#include <cstddef>
#include <system_error>
#include <utility>
#include <vector>

#include "KittiCalibFinder.h"
#include "conversion/FoundTimes.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double kitti_dt = 0.1034;  //!< [s] HDL-64E at about 9.67 Hz

struct TimesOfFile
{
  std::string file;  //!< empty: none was found
  std::vector<double> times;
  KittiTimes kind = KittiTimes::of_file;
};

/** KITTI has no times of its tracking sequences: a file that others may have put there, where
 * dyslam-eval kitti-mot reads it, too. */
fs::path timesOfSequence(const fs::path& folder, const std::string& sequence)
{
  return folder / "times" / (sequence + ".txt");
}

std::string warningOfMissingTimes(const fs::path& folder,
                                  const std::string& sequence,
                                  KittiKind kind)
{
  const std::string missing =
      kind == KittiKind::kitti360
          ? "velodyne_points/timestamps.txt, a download of its own (data_3d_timestamps.zip)"
      : kind == KittiKind::raw ? "velodyne_points/timestamps.txt or times.txt"
      : sequence.empty()       ? "times.txt"
                               : timesOfSequence(folder, sequence).string();
  return "no " + missing +
         ": 0.1034 s between scans is assumed; give --dt, or a file of times with --times of "
         "kitti2rawlog";
}

/** The times that the options name or the layout has, else those that lie with the scans. Appends
 * notes and warnings. */
TimesOfFile findTimesFile(const fs::path& folder,
                          const std::string& sequence,
                          const KittiConverterOptions& options,
                          KittiLayout& layout)
{
  TimesOfFile result;
  std::vector<fs::path> candidates{folder / "times.txt",
                                   folder / "velodyne_points" / "timestamps.txt"};
  if (!sequence.empty())
  {
    candidates.insert(candidates.begin(), timesOfSequence(folder, sequence));
  }
  result.file = firstExisting(options.times, candidates);
  if (!result.file.empty())
  {
    const bool is_raw =
        options.times.empty() && fs::path(result.file).filename() == "timestamps.txt";
    result.kind = is_raw ? KittiTimes::of_raw : KittiTimes::of_file;
    result.times = readTimesOrTimestamps(result.file);
    return result;
  }
  const std::string of_scans = fs::path(layout.entries.front().scan).parent_path().string();
  FoundTimes found = findTimes(of_scans, layout.entries.size());
  if (!found.why_unused.empty())
  {
    layout.warnings.push_back(found.why_unused);
  }
  if (found.file.empty())
  {
    layout.warnings.push_back(warningOfMissingTimes(folder, sequence, options.kind));
    return result;
  }
  layout.notes.push_back("time stamps: " + found.file);
  result.file = found.file;
  result.times = std::move(found.stamps);
  return result;
}

/** \throws UserError for a scan without a time. */
void setStamps(const TimesOfFile& from, std::vector<KittiLayout::Entry>& entries)
{
  const std::vector<double>& times = from.times;
  // A line for each frame number, or for each scan where numbers are left out.
  const bool by_scan = entries.back().number >= times.size() && times.size() == entries.size();
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    const std::size_t number = by_scan ? i : entries[i].number;
    if (number >= times.size())
    {
      throw UserError(from.file + ": has " + std::to_string(times.size()) +
                      " times, none for scan " + std::to_string(number));
    }
    if (std::isnan(times[number]))
    {
      throw UserError(from.file + ": has an empty line instead of a time for scan " +
                      std::to_string(number));
    }
    entries[i].stamp = times[number];
  }
}
}  // namespace

KittiTimes readKittiTimes(const fs::path& folder,
                          const std::string& sequence,
                          const KittiConverterOptions& options,
                          KittiLayout& layout)
{
  if (options.dt > 0 && !options.times.empty())
  {
    throw UserError("--times and --dt exclude each other");
  }
  const TimesOfFile found =
      options.dt == 0 ? findTimesFile(folder, sequence, options, layout) : TimesOfFile();
  if (!found.file.empty())
  {
    setStamps(found, layout.entries);
    return found.kind;
  }
  const double dt = options.dt > 0 ? options.dt : kitti_dt;
  const std::size_t first = layout.entries.front().number;
  for (KittiLayout::Entry& entry : layout.entries)
  {
    entry.stamp = static_cast<double>(entry.number - first) * dt;
  }
  return KittiTimes::assumed;
}

void findPointTimes(const fs::path& folder, KittiLayout& layout)
{
  const fs::path times = folder / point_time_folder;
  std::size_t found = 0;
  for (KittiLayout::Entry& entry : layout.entries)
  {
    const fs::path file = times / (fs::path(entry.scan).stem().string() + ".time");
    std::error_code none;
    if (fs::is_regular_file(file, none))
    {
      entry.times = file.string();
      ++found;
    }
  }
  layout.has_point_times = found > 0;
  if (found > 0 && found < layout.entries.size())
  {
    layout.warnings.push_back(times.string() + ": point times for " + std::to_string(found) +
                              " of " + counted(layout.entries.size(), "scan"));
  }
}
}  // namespace dyslam
