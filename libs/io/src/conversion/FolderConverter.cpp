// SPDX-License-Identifier: BSD-3-Clause
#include "FolderConverter.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "FoundTimes.h"
#include "NameStamps.h"

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

std::string stepText(double dt)
{
  std::ostringstream text;
  text << dt;
  return text.str();
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
  sink.note("time stamps: numbers in the file names, " + stepText(dt) + " s apart");
  return stamps;
}

/** Median range of the points, without those at the origin and those that are no numbers [m]; 0
 * without any. */
float medianRange(const Scan& scan)
{
  std::vector<float> ranges;
  ranges.reserve(scan.size());
  for (const Eigen::Vector3f& point : scan.points)
  {
    if (const float range = point.stableNorm(); range > 0 && std::isfinite(range))
    {
      ranges.push_back(range);
    }
  }
  return ranges.empty() ? 0 : upperMedian(ranges);
}

/** Share of the points, without those at the origin, whose coordinates are all whole numbers; 0 of
 * few points. */
double shareOfWholeNumbers(const Scan& scan)
{
  constexpr std::size_t few = 1000;
  std::size_t points = 0;
  std::size_t whole = 0;
  for (const Eigen::Vector3f& point : scan.points)
  {
    if (point.allFinite() && !point.isZero(0))
    {
      ++points;
      whole += point.array().round().matrix() == point ? 1 : 0;
    }
  }
  return points < few ? 0 : static_cast<double>(whole) / static_cast<double>(points);
}

/** What is unusual about the scans of a folder. */
struct FolderFindings
{
  bool assumed_times = false;  //!< scans that are taken as equally far apart
  std::size_t empty = 0;       //!< files without points
  std::string first_empty;
  std::string first_with_points;
  double odd_intensities = 0;  //!< share of those of that file that no lidar gives
  float median_range = 0;      //!< of that file [m]
  double whole_numbers = 0;    //!< shareOfWholeNumbers() of that file

  /** \throws UserError if the first file with points has no scan of a lidar. */
  void add(const Scan& scan, bool has_stamp, const std::string& file)
  {
    assumed_times = assumed_times || !has_stamp;
    if (first_with_points.empty() && scan.size() > 0)
    {
      first_with_points = file;
      constexpr float highest = 65535;  // of 16 bits
      const auto odd =
          std::count_if(scan.intensity.begin(), scan.intensity.end(),
                        [](float intensity) { return !(intensity >= 0 && intensity <= highest); });
      odd_intensities = static_cast<double>(odd) / static_cast<double>(scan.size());
      median_range = medianRange(scan);
      whole_numbers = shareOfWholeNumbers(scan);
      constexpr float farthest = 1e5F;
      if (median_range > farthest)
      {
        throw UserError(
            file + ": half of its points are more than 100 km from the origin: " +
            (lowerExtension(file) == ".bin"
                 ? "its columns are probably not x y z intensity (float32), or not "
                   "relative to the lidar; --bin-layout names its columns, a letter each"
                 : "its coordinates are not relative to the lidar; subtract an origin"));
      }
    }
    if (scan.size() == 0)
    {
      first_empty = empty == 0 ? fs::path(file).filename().string() : first_empty;
      ++empty;
    }
  }
};

/** Warns if the files are taken as `dt` apart, though numbers are missing between them. */
void warnAboutGaps(const std::vector<std::string>& files, double dt, ScanSink& sink)
{
  const std::vector<int> numbers = numbersFromNames(files);
  const auto gap =
      std::adjacent_find(numbers.begin(), numbers.end(), [](int a, int b) { return b - a > 1; });
  if (gap == numbers.end())
  {
    return;
  }
  const auto before = static_cast<std::size_t>(gap - numbers.begin());
  sink.warn("file numbers have gaps: " + fs::path(files[before + 1]).filename().string() +
            " follows " + fs::path(files[before]).filename().string() + "; scans are taken as " +
            stepText(dt) +
            " s apart (--by-number of scans2rawlog takes their times from their numbers)");
}

/** Warns if the folder of the scans is part of a KITTI recording. */
void warnAboutKitti(const std::string& input, ScanSink& sink)
{
  const fs::path folder = fs::absolute(fs::path(input) / "").lexically_normal().parent_path();
  const bool is_data = folder.filename() == "data";
  const fs::path recording = is_data ? folder.parent_path().parent_path() : folder.parent_path();
  const fs::path scans = is_data ? "velodyne_points/data" : "velodyne";
  const std::optional<KittiKind> kind = officialKittiKind(recording.string());
  if (!kind || recording / scans != folder)
  {
    return;
  }
  sink.warn("the scans are those of a KITTI recording; give its folder, -i " + recording.string() +
            ", for its true poses" +
            (*kind == KittiKind::odometry ? ", and because its scans are already deskewed" : ""));
}

/** Warns of coordinates that are not in metres. Distances alone do not show centimetres: those of a
 * lidar on a drone are as large in metres. */
void warnAboutLengths(const FolderFindings& findings, double scale, ScanSink& sink)
{
  const std::string file = fs::path(findings.first_with_points).filename().string();
  const std::string millimetres = "millimetres (--scale 0.001)";
  const std::string or_centimetres = " or in centimetres (--scale 0.01)";
  constexpr float implausible = 1000;               // [m]
  constexpr float implausible_centimetres = 10000;  // [cm]
  if (findings.median_range > implausible)
  {
    sink.warn(file + ": half of its points are more than " +
              std::to_string(std::lround(findings.median_range)) +
              " m away: its coordinates are probably in " + millimetres +
              (findings.median_range < implausible_centimetres ? or_centimetres : ""));
    return;
  }
  constexpr double nearly_all = 0.99;
  if (scale == 1 && findings.whole_numbers > nearly_all)
  {
    sink.warn(file + ": its coordinates are whole numbers: they are probably in " + millimetres +
              or_centimetres);
  }
}

void warnAbout(const FolderFindings& findings,
               const std::vector<std::string>& files,
               const ScanConverterOptions& options,
               ScanSink& sink)
{
  if (findings.assumed_times)
  {
    warnAboutGaps(files, options.dt > 0 ? options.dt : assumed_dt, sink);
  }
  if (findings.empty > 0)
  {
    sink.warn(counted(findings.empty, "file") + " without points, the first is " +
              findings.first_empty + ": empty scans are written");
  }
  constexpr double many = 0.05;
  if (findings.odd_intensities > many && lowerExtension(findings.first_with_points) == ".bin")
  {
    sink.warn(fs::path(findings.first_with_points).filename().string() + ": " +
              std::to_string(std::lround(100 * findings.odd_intensities)) +
              " % of the intensities are negative, above 65535 or no numbers: its columns are "
              "probably not x y z intensity (float32); --bin-layout names them, a letter each");
  }
  warnAboutLengths(findings, options.scale, sink);
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
    sink.warn(times + ": its times are " + stepText(usual) +
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
  const std::vector<double> stamps = stampsFromNames(files);
  const std::string example = fs::path(files.front()).filename().string();
  if (!stamps.empty())
  {
    sink.note("time stamps: the file names (" + example + ")");
    return stamps;
  }
  sink.note("the file names (" + example + ") are not taken as time stamps");
  return haveOwnTimes(files, layout, options) ? stamps : stampsOfFoundFile(files, sink);
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
  if (!poses.empty())
  {
    sink.setPoseOrigin(PoseSource::given, nameOfFile(options.poses));
  }
  FieldConventions conventions(options.scale);
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
  warnAbout(findings, files, options, sink);
  warnAboutKitti(input, sink);
  for (const std::string& note : conventions.notes())
  {
    sink.note(note);
  }
  for (const std::string& warning : conventions.warnings())
  {
    sink.warn(warning);
  }
}
}  // namespace dyslam
