// SPDX-License-Identifier: BSD-3-Clause
#include "FolderConverter.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "FolderFindings.h"
#include "FoundTimes.h"
#include "NameStamps.h"
#include "recording/LateStamps.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::vector<Pose> readPosesFor(const std::string& path, std::size_t scans)
{
  std::vector<Pose> poses;
  if (path.empty())
  {
    return poses;
  }
  for (const StampedPose& pose : readTrajectory(path).trajectory)
  {
    poses.push_back(pose.pose);
  }
  if (poses.size() != scans)
  {
    throw UserError(path + ": has " + counted(poses.size(), "pose") + ", but there are " +
                    counted(scans, "scan"));
  }
  return poses;
}

/** Times by the numbers in the files' names, counted from the first. \throws UserError. */
std::vector<double> stampsByNumber(const std::vector<std::string>& files,
                                   const ScanConverterOptions& options,
                                   ScanSink& sink)
{
  const std::vector<int> numbers = numbersFromNames(files);
  if (numbers.empty())
  {
    throw UserError(fs::path(files.front()).parent_path().string() +
                    ": --by-number: the file names do not end in ascending numbers of at most nine "
                    "digits after leading zeros, with the same text before them; give --times");
  }
  const double dt = options.dt > 0 ? options.dt : assumed_dt;
  std::vector<double> stamps;
  stamps.reserve(numbers.size());
  for (const int number : numbers)
  {
    stamps.push_back(static_cast<double>(number - numbers.front()) * dt);
  }
  sink.note("time stamps: numbers in the file names, " + secondsText(dt) + " s apart");
  return stamps;
}

/** Warns of times that are not in seconds. \param stamps of the scans, in their order [s] */
void warnAboutUnit(const std::string& times, const std::vector<double>& stamps, ScanSink& sink)
{
  constexpr double shortest = 1e-3;  // usual time between scans [s]
  constexpr double longest = 60;     // [s]
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i)
  {
    steps.push_back(stamps[i] - stamps[i - 1]);
  }
  const double usual = steps.empty() ? longest : upperMedian(steps);
  if (usual < shortest || usual > longest)
  {
    sink.warn(times + ": its times are " + secondsText(usual) +
              " s apart: times that count from the start of the recording must be in seconds");
  }
}

/** The columns of a folder's .bin files: as requested, or those of the first one with points; empty
 * for other files. */
std::string layoutOfBins(const std::vector<std::string>& files, const ScanConverterOptions& options)
{
  if (lowerExtension(files.front()) != ".bin")
  {
    return {};
  }
  const auto with_points = std::find_if(
      files.begin(), files.end(), [](const std::string& file) { return fs::file_size(file) > 0; });
  return !options.bin_layout.empty()  ? options.bin_layout
         : with_points == files.end() ? kitti_layout
                                      : binLayoutOf(*with_points);
}

/** Reads a scan of a folder. \param layout of its .bin files; empty: other files */
Scan readFile(const std::string& file, const std::string& layout, FieldConventions& conventions)
{
  return layout.empty() ? readCloud(file, conventions) : readBin(file, layout, conventions);
}

/** Whether the first scan with points has a time of its own. */
bool haveOwnTimes(const std::vector<std::string>& files,
                  const std::string& layout,
                  const ScanConverterOptions& options)
{
  FieldConventions conventions(options.scale);
  for (const std::string& file : files)
  {
    const Scan scan = readFile(file, layout, conventions);
    if (scan.size() > 0)
    {
      return scan.stamp != 0;
    }
  }
  return false;
}

/** Times of a file that lies with the scans; empty if there is none that can be used. */
std::vector<double> stampsOfFoundFile(const std::vector<std::string>& files, ScanSink& sink)
{
  FoundTimes found = findTimes(fs::path(files.front()).parent_path().string(), files.size());
  if (!found.why_unused.empty())
  {
    sink.warn(found.why_unused);
  }
  if (!found.file.empty())
  {
    sink.note("time stamps: " + found.file);
    warnAboutUnit(found.file, found.stamps, sink);
  }
  return std::move(found.stamps);
}

/** A time for each scan of a folder; empty if only the scans themselves have times. May put the
 * files in another order. \param layout of .bin files */
std::vector<double> stampsFor(std::vector<std::string>& files,
                              const std::string& layout,
                              const ScanConverterOptions& options,
                              ScanSink& sink)
{
  if (!options.times.empty())
  {
    std::vector<double> stamps = readTimesOfScans(options.times);
    if (stamps.size() != files.size())
    {
      throw UserError(options.times + ": has " + counted(stamps.size(), "time") +
                      ", but there are " + counted(files.size(), "scan"));
    }
    sink.note("time stamps: " + options.times);
    warnAboutUnit(options.times, stamps, sink);
    return stamps;
  }
  if (options.by_number)
  {
    return stampsByNumber(files, options, sink);
  }
  if (options.dt > 0)
  {
    return {};
  }
  std::vector<double> stamps = stampsFromNames(files);
  if (stamps.empty() && !haveOwnTimes(files, layout, options))
  {
    stamps = stampsOfFoundFile(files, sink);
    if (!stamps.empty())
    {
      return stamps;
    }
    stamps = secondsFromNames(files);
  }
  const std::string example =
      "the file names (" + fs::path(files.front()).filename().string() + ")";
  sink.note(stamps.empty() ? example + " are not taken as time stamps" : "time stamps: " + example);
  return stamps;
}

void report(const FieldConventions& conventions, const LateStamps& late_stamps, ScanSink& sink)
{
  for (const std::string& note : conventions.notes())
  {
    sink.note(note);
  }
  for (const std::string& note : late_stamps.notes())
  {
    sink.note(note);
  }
  for (const std::string& warning : conventions.warnings())
  {
    sink.warn(warning);
  }
}
}  // namespace

ScanFolder findScanFolder(const std::string& input, const ScanConverterOptions& options)
{
  ScanFolder folder;
  folder.files = listCloudFiles(input);
  const std::string ending = lowerExtension(folder.files.front());
  if (!options.bin_layout.empty() && ending != ".bin")
  {
    throw UserError(input + ": --bin-layout is for .bin files, those of " + ending +
                    " name their columns; leave it out");
  }
  folder.poses = readPosesFor(options.poses, folder.files.size());
  return folder;
}

void convertFolder(const std::string& input,
                   const ScanFolder& folder,
                   ScanSink& sink,
                   const ScanConverterOptions& options)
{
  std::vector<std::string> files = folder.files;
  const std::vector<Pose>& poses = folder.poses;
  const std::string layout = layoutOfBins(files, options);
  const std::vector<double> stamps = stampsFor(files, layout, options, sink);
  if (!layout.empty() && layout != kitti_layout)
  {
    sink.note("points: " + columnsOf(layout) + " (--bin-layout " + layout + ")");
  }
  FieldConventions conventions(options.scale);
  LateStamps late_stamps;
  FolderFindings findings;
  findings.assumed_times = options.dt > 0 && !options.by_number;
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    Scan scan = readFile(files[i], layout, conventions);
    if (options.by_number)
    {
      scan.stamp = stamps[i];
    }
    else if (!stamps.empty())
    {
      conventions.restamp(scan, stamps[i]);
    }
    const bool has_stamp = !stamps.empty() || scan.stamp != 0;
    findings.add(scan, has_stamp, files[i]);
    if (poses.empty())  // they are of the stamps
    {
      late_stamps(scan);
    }
    if (!sink.put(std::move(scan), has_stamp,
                  i < poses.size() ? std::optional<Pose>(poses[i]) : std::nullopt,
                  static_cast<double>(i + 1) / static_cast<double>(files.size())))
    {
      break;
    }
  }
  if (sink.written() == 0)
  {
    throw UserError(input + ": " + emptyRange(options) + " of the " +
                    counted(files.size(), "scan"));
  }
  warnAbout(findings, input, files, options, sink);
  report(conventions, late_stamps, sink);
}
}  // namespace dyslam
