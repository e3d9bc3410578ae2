// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/formats/FieldConventions.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/Converters.h>
#include <dyslam/packets/VelodyneModels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "CaptureConverter.h"
#include "NameStamps.h"
#include "ScanSink.h"
#include "bags/BagConverter.h"

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
    throw UserError(path + ": has " + std::to_string(poses.size()) + " poses, but there are " +
                    std::to_string(scans) + " scans");
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

/** What is unusual about the scans of a folder. */
struct FolderFindings
{
  bool assumed_times = false;  //!< scans that are taken as equally far apart
  std::size_t empty = 0;       //!< files without points
  std::string first_empty;
  std::string first_with_points;
  double odd_intensities = 0;  //!< share of those of that file that no lidar gives
  float median_range = 0;      //!< of that file [m]

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
            stepText(dt) + " s apart (--by-number takes their times from their numbers)");
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
  constexpr float implausible = 1000;
  if (findings.median_range > implausible)
  {
    sink.warn(fs::path(findings.first_with_points).filename().string() +
              ": half of its points are more than " +
              std::to_string(std::lround(findings.median_range)) +
              " m away: its coordinates are probably in millimetres (--scale 0.001)");
  }
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

/** A time for each scan of a folder; empty if only the scans themselves have times. May put the
 * files in another order. */
std::vector<double> stampsFor(std::vector<std::string>& files,
                              const ScanConverterOptions& options,
                              ScanSink& sink)
{
  if (!options.times.empty())
  {
    std::vector<double> stamps = readTimesOrTimestamps(options.times);
    stamps.erase(std::remove_if(stamps.begin(), stamps.end(),  // of lost scans, without a file
                                [](double stamp) { return std::isnan(stamp); }),
                 stamps.end());
    std::transform(stamps.begin(), stamps.end(), stamps.begin(), secondsOf);
    if (stamps.size() != files.size())
    {
      throw UserError(options.times + ": has " + std::to_string(stamps.size()) +
                      " times, but there are " + std::to_string(files.size()) + " scans");
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
  sink.note(stamps.empty() ? "the file names (" + example + ") are not taken as time stamps"
                           : "time stamps: the file names (" + example + ")");
  return stamps;
}

/** The columns of a folder's .bin files: as requested, or those of the first one with points. */
std::string binLayoutFor(const std::vector<std::string>& files,
                         const ScanConverterOptions& options,
                         ScanSink& sink)
{
  const auto with_points = std::find_if(
      files.begin(), files.end(), [](const std::string& file) { return fs::file_size(file) > 0; });
  const std::string layout = !options.bin_layout.empty()  ? options.bin_layout
                             : with_points == files.end() ? kitti_layout
                                                          : binLayoutOf(*with_points);
  if (layout != kitti_layout)
  {
    sink.note("points: " + columnsOf(layout) + " (--bin-layout " + layout + ")");
  }
  return layout;
}

void convertFolder(const std::string& input,
                   ScanSink& sink,
                   std::vector<std::string> files,
                   const std::vector<Pose>& poses,
                   const ScanConverterOptions& options)
{
  const std::vector<double> stamps = stampsFor(files, options, sink);
  const bool are_bins = lowerExtension(files.front()) == ".bin";
  const std::string layout = are_bins ? binLayoutFor(files, options, sink) : "";
  if (!poses.empty())
  {
    sink.setPoseOrigin(PoseSource::given, nameOfFile(options.poses));
  }
  FieldConventions conventions(options.scale);
  FolderFindings findings;
  findings.assumed_times = options.dt > 0 && !options.by_number;
  for (std::size_t i = 0; i < files.size(); ++i)
  {
    Scan scan =
        are_bins ? readBin(files[i], layout, conventions) : readCloud(files[i], conventions);
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
    throw UserError(input + ": " + emptyRange(options) + " of the " + std::to_string(files.size()) +
                    " scans");
  }
  warnAbout(findings, files, options, sink);
  for (const std::string& note : conventions.notes())
  {
    sink.note(note);
  }
  for (const std::string& warning : conventions.warnings())
  {
    sink.warn(warning);
  }
}

enum class InputKind
{
  folder,
  pcap,
  bag
};

/** \throws UserError for a file that is known to be no network capture. */
void requireCapture(const std::string& file)
{
  const std::string ending = lowerExtension(file);
  if (isCloudFile(file))
  {
    throw UserError(file + ": is a single scan; give the folder of the scans");
  }
  if (const std::string command = unpackCommand(file); !command.empty())
  {
    throw UserError(file + ": is compressed; unpack it first: " + command + " " + file);
  }
  if (ending == ".osf")
  {
    throw UserError(file + ": " + conversionAdvice(file));
  }
  if (ending == ".rawlog")
  {
    throw UserError(file + ": ends in .rawlog: dyslam reads rawlogs as they are");
  }
  if (fs::path(file).filename() == "metadata.yaml")
  {
    throw UserError(file + ": is only the description of a ROS 2 bag; give the bag's folder");
  }
}

/** \throws UserError for an option that does not apply to this kind of input. */
void requireFitting(InputKind kind, const ScanConverterOptions& options)
{
  struct Use
  {
    const char* flag;
    bool given;
    InputKind kind;
    const char* with;
  };
  for (const Use& use :
       {Use{"--poses", !options.poses.empty(), InputKind::folder, "a folder of scans"},
        Use{"--times", !options.times.empty(), InputKind::folder, "a folder of scans"},
        Use{"--by-number", options.by_number, InputKind::folder, "a folder of scans"},
        Use{"--truth-topic", !options.truth_topic.empty(), InputKind::bag, "a bag"},
        Use{"--truth-frame", !options.truth_frame.empty(), InputKind::bag, "a bag"},
        Use{"--imu-pose", !options.imu_pose.empty(), InputKind::bag, "a bag"}})
  {
    if (use.given && use.kind != kind)
    {
      throw UserError(std::string(use.flag) + " works with " + use.with + " only");
    }
  }
  if (kind == InputKind::folder && options.keep_partial)
  {
    throw UserError("--keep-partial works with the packets of a .pcap or a bag only");
  }
  options.requireFitting(kind == InputKind::bag      ? RecordingKind::bag
                         : kind == InputKind::folder ? RecordingKind::scans
                                                     : RecordingKind::capture);
  if (!options.times.empty() && options.dt > 0)
  {
    throw UserError("--times and --dt exclude each other");
  }
  if (options.imu && options.dt > 0)
  {
    throw UserError(
        "--imu and --dt exclude each other: the samples of the IMU have the lidar's times");
  }
  if (!options.times.empty() && options.by_number)
  {
    throw UserError("--times and --by-number exclude each other");
  }
  if (options.pose_source != PoseSource::unknown && options.poses.empty() &&
      options.truth_topic.empty())
  {
    throw UserError("--pose-source states where --poses or --truth-topic are from; give one, too");
  }
  if (!options.base_frame.empty() && !options.sensor_pose.empty())
  {
    throw UserError(
        "--base-frame takes the pose of the lidar from the bag, --sensor-pose states it; "
        "give one of them");
  }
  if (!options.truth_frame.empty() && options.truth_topic.empty())
  {
    throw UserError("--truth-frame chooses one of the bodies of --truth-topic; give that, too");
  }
  if (!options.imu_pose.empty() && options.imu_topic.empty())
  {
    throw UserError("--imu-pose states where the IMU of --imu-topic is mounted; give that, too");
  }
}
}  // namespace

void ScanConverterOptions::describe(OptionsVisitor& visitor)
{
  const std::string sensors =
      "model of the Velodyne of packets, " + velodyneModelNames() + "; else the scans' label";
  visitor.text("sensor", sensor, sensors.c_str());
  visitor.text("calibration", calibration,
               "for packets: Velodyne XML or YAML calibration, or metadata of an Ouster (.json)");
  visitor.text("poses", poses, "file of TUM or KITTI poses of the lidar, a line for each scan");
  visitor.text("times", times, "file of times, a line for each scan of a folder");
  visitor.text("topic", topic, "topic of a bag's scans; empty: the most likely lidar");
  visitor.text("truth_topic", truth_topic,
               "topic of a bag's true poses of the vehicle; empty: none");
  visitor.text("truth_frame", truth_frame, "child frame of the poses in truth_topic");
  visitor.text("imu_topic", imu_topic, "topic of a bag's IMU; empty: none");
  visitor.flag("imu", imu, "convert the IMU in the Ouster of a capture, too");
  visitor.text("imu_pose", imu_pose,
               "pose of the IMU on the vehicle, x y z yaw pitch roll; empty: by the bag's "
               "/tf_static [m, deg]");
  visitor.text("odometry_topic", odometry_topic,
               "topic of the measured speed of a bag's vehicle; empty: none");
  visitor.text("gnss_topic", gnss_topic, "topic of a bag's satellite receiver; empty: none");
  visitor.text("sensor_pose", sensor_pose,
               "pose of the lidar on the vehicle, x y z yaw pitch roll; empty: identity [m, deg]");
  visitor.text("base_frame", base_frame,
               "frame of the vehicle in a bag's /tf_static, which places the lidar in it; empty: "
               "sensor_pose");
  visitor.real("dt", dt, 0, 3600, "time between scans; 0: the scans' own times, else 0.1 [s]");
  visitor.real(
      "scale", scale, 1e-6, 1e6,
      "length of the unit of the coordinates in a folder of scans; 0.001: millimetres [m]");
  visitor.text("bin_layout", bin_layout,
               "columns of a folder's .bin files, a letter each; empty: by their content");
  visitor.flag("by_number", by_number,
               "times of a folder's scans by the numbers in their names, dt apart");
  visitor.flag("keep_partial", keep_partial, "convert also incomplete first and last revolutions");
  describePoseSource(
      visitor, "pose_source", pose_source,
      "source of the poses of poses or truth_topic; unknown: given, of unknown accuracy");
  describeConversion(visitor);
}

ConversionResult convertScans(const std::string& input,
                              const std::string& output,
                              const ScanConverterOptions& options,
                              const ConversionProgress& progress,
                              const BagUnpackingProgress& unpacking)
{
  validate(options, "scans2rawlog");
  if (!fs::exists(input))
  {
    throw UserError(input + ": no such file or folder");
  }
  std::vector<std::string> inputs = options.files();
  inputs.insert(inputs.end(), {input, options.poses, options.times});
  requireNoInput(output, inputs);
  const InputKind kind = isBag(input)              ? InputKind::bag
                         : fs::is_directory(input) ? InputKind::folder
                                                   : InputKind::pcap;
  requireFitting(kind, options);
  const bool folder = kind == InputKind::folder;
  const auto files = folder ? listCloudFiles(input) : std::vector<std::string>{};
  if (!options.bin_layout.empty() && lowerExtension(files.front()) != ".bin")
  {
    throw UserError(input + ": --bin-layout is for .bin files, those of " +
                    lowerExtension(files.front()) + " name their columns; leave it out");
  }
  const auto poses = folder ? readPosesFor(options.poses, files.size()) : std::vector<Pose>{};
  if (kind == InputKind::pcap)
  {
    requireCapture(input);
  }
  // Made last: bad input must not touch an earlier output.
  ScanSink sink(output, options);
  sink.setProgress(progress);
  return sink.fill(
      [&]
      {
        switch (kind)
        {
          case InputKind::folder:
            convertFolder(input, sink, files, poses, options);
            break;
          case InputKind::pcap:
            convertCapture(input, sink, options);
            break;
          case InputKind::bag:
            convertBag(input, sink, options, unpacking);
            break;
        }
        return sink.close();
      });
}
}  // namespace dyslam
