// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Labels.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/BagExport.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "BagOutput.h"
#include "OdometryMessages.h"
#include "SampleMessages.h"
#include "TrackMarkers.h"
#include "conversion/ConversionOutput.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double pose_tolerance = 1e-3;  //!< [s] between a scan and its pose
constexpr double pose_max_gap = 0.5;     //!< [s] between poses, for interpolation

constexpr const char* map_name = "map";      // frame of the trajectory
constexpr const char* world_name = "world";  // frame of the true poses
constexpr const char* lidar_name = "lidar";

/** \throws UserError for options that need others, and for a file that may not be written. */
void requireConsistent(const std::string& output, const BagExportOptions& options)
{
  if (fs::path(output).extension() != ".mcap")
  {
    throw UserError(output + ": name the bag to write *.mcap (--output)");
  }
  if (!options.force && fs::exists(output))
  {
    throw UserError(output +
                    ": is there already; choose another --output, or replace it with "
                    "--force");
  }
  for (const auto& [file, flag] :
       {std::pair<std::string, const char*>{options.tracks, "--tracks"}, {options.map, "--map"}})
  {
    if (!file.empty() && options.trajectory.empty())
    {
      throw UserError(std::string(flag) + " " + file +
                      ": is written in the frame of the map, which needs the poses of the scans: "
                      "give --trajectory");
    }
  }
  if (options.static_only && options.labels.empty())
  {
    throw UserError(
        "--static-only: needs labels of the moving points: give --labels, or a run that was made "
        "with dyslam --labels");
  }
  if (options.static_only && options.no_scans)
  {
    throw UserError("--static-only: chooses scans, and --no-scans leaves all out; give one");
  }
}

/** \return T_map_vehicle by time \throws UserError. */
Trajectory readTimedPoses(const std::string& path)
{
  if (path.empty())
  {
    return {};
  }
  TrajectoryFile file = readTrajectory(path);
  if (file.format == TrajectoryFormat::kitti)
  {
    throw UserError(path +
                    ": has no times, which place the poses at the scans; give the TUM file "
                    "of the run (--trajectory)");
  }
  return std::move(file.trajectory);
}

/** \return the folder that has the label files; empty for none \throws UserError. */
std::string labelFolder(const std::string& given)
{
  if (given.empty())
  {
    return given;
  }
  const auto labels = labelFolderOf(given);
  if (!labels)
  {
    throw UserError(given + ": is not a folder of .label files (--labels)");
  }
  return *labels;
}

/** A message of what a file has. \param encode makes it \param advice ends the error's text
 * \throws UserError naming the file, if ROS 2 has no such message. */
template <typename Encode>
std::string encodedFrom(const std::string& file, const std::string& advice, const Encode& encode)
{
  try
  {
    return encode();
  }
  catch (const UserError& error)
  {
    throw UserError(file + ": " + error.what() + " (" + advice + ")");
  }
}

/** Flags that choose the first scans of a range: "--skip-first-n 20 --only-first-n 40". */
std::string flagsOfFirst(const ScanRange& range, std::size_t scans)
{
  std::string flags;
  if (range.skip_first_n > 0)
  {
    flags += "--skip-first-n " + std::to_string(range.skip_first_n) + " ";
  }
  if (range.start > 0)
  {
    flags += formatted("--start %.10g ", range.start);
  }
  return flags + "--only-first-n " + std::to_string(scans);
}

/** The next scan. \param before number of scans read before it \throws UserError after damage,
 * with the flags that choose the scans before it. */
std::optional<Frame> nextFrame(RawlogSource& source, const ScanRange& range, std::size_t before)
{
  try
  {
    return source.next();
  }
  catch (const UserError& error)
  {
    if (before == 0)
    {
      throw;
    }
    throw UserError(std::string(error.what()) + "; the scans before it can be written with " +
                    flagsOfFirst(range, before));
  }
}

/** One bag while it is written; removed with the object unless finish() was called. */
class RecordingBag
{
 public:
  RecordingBag(const std::string& rawlog,
               const std::string& output,
               const BagExportOptions& options)
      : rawlog_(rawlog),
        options_(options),
        poses_(readTimedPoses(options.trajectory)),
        odometry_(poses_, options.motions),
        labels_(labelFolder(options.labels)),
        bag_(output)
  {
    if (!options.tracks.empty())
    {
      tracks_.emplace(options.tracks);
    }
  }

  void add(const Frame& frame)
  {
    const double stamp = frame.scan.stamp;
    requireStamp(frame);
    first_stamp_ = result_.scans == 0 ? stamp : first_stamp_;
    last_stamp_ = stamp;
    samples_.take(frame, bag_);
    bag_.place(lidar_name, frame.scan.T_vehicle_lidar);
    bag_.writeSensors(std::min(samples_.oldest().value_or(stamp), stamp));
    samples_.writeUpTo(stamp, bag_);
    const std::optional<Pose> T_map_vehicle = poseAt(stamp);
    writePoses(frame, T_map_vehicle);
    if (result_.scans == 0 && hasTrajectory())
    {
      writeOnce(stamp);
    }
    if (!options_.no_scans)
    {
      writeScan(frame);
    }
    if (tracks_ && T_map_vehicle)
    {
      const auto markers =
          tracks_->at(frame.index, stamp, *T_map_vehicle, frame.scan.T_vehicle_lidar);
      bag_.write({"/objects", RosType::marker_array}, stamp,
                 markersMessage(stamp, map_name, markers));
      result_.boxes += tracks_->boxes(frame.index);
    }
    ++result_.scans;
  }

  ConversionResult finish()
  {
    samples_.writeUpTo(std::numeric_limits<double>::infinity(), bag_);
    if (hasTrajectory())
    {
      checkPoses();
    }
    if (result_.poses > 0)
    {
      result_.pose_source = hasTrajectory() ? options_.trajectory : "the rawlog";
    }
    if (tracks_ && !tracks_->warning().empty())
    {
      result_.warnings.push_back(tracks_->warning());
    }
    if (tracks_ && result_.boxes == 0)
    {
      result_.warnings.push_back(options_.tracks + ": has no box of these scans");
    }
    bag_.close();
    return result_;
  }

 private:
  /** \throws UserError for a stamp that no message holds. */
  void requireStamp(const Frame& frame) const
  {
    try
    {
      (void)rosNanoseconds(frame.scan.stamp);
    }
    catch (const UserError& error)
    {
      throw UserError(rawlog_ + ": scan " + std::to_string(frame.index) + ": " + error.what());
    }
  }

  [[nodiscard]] bool hasTrajectory() const { return !options_.trajectory.empty(); }

  /** T_map_vehicle; nothing where the trajectory has a gap. */
  [[nodiscard]] std::optional<Pose> poseAt(double stamp) const
  {
    if (const auto nearest = poses_.nearest(stamp, pose_tolerance))
    {
      return poses_[*nearest].pose;
    }
    return poses_.at(stamp, pose_max_gap);
  }

  void writePoses(const Frame& frame, const std::optional<Pose>& T_map_vehicle)
  {
    const double stamp = frame.scan.stamp;
    const std::optional<Pose>& truth = frame.T_world_vehicle_truth;
    const std::optional<Pose>& pose = hasTrajectory() ? T_map_vehicle : truth;
    const char* parent = hasTrajectory() ? map_name : world_name;
    if (pose)
    {
      bag_.write({"/tf", RosType::transforms}, stamp,
                 transformsMessage({{stamp, parent, vehicle_name, *pose}}));
      ++result_.poses;
    }
    if (T_map_vehicle)
    {
      bag_.write({"/odometry", RosType::odometry}, stamp,
                 odometry_.of({stamp, map_name, vehicle_name, *T_map_vehicle}));
    }
    if (truth && T_map_vehicle && !T_map_world_)
    {
      T_map_world_ = *T_map_vehicle * truth->inverse();
    }
    if (truth && (T_map_world_ || !hasTrajectory()))
    {
      const Pose T_parent_vehicle = T_map_world_.value_or(Pose::Identity()) * *truth;
      bag_.write({"/ground_truth", RosType::pose_stamped}, stamp,
                 poseMessage({stamp, parent, "", T_parent_vehicle}));
    }
  }

  /** Path and map. \throws UserError */
  void writeOnce(double stamp)
  {
    bag_.write({"/path", RosType::path, true}, stamp,
               encodedFrom(options_.trajectory, "--trajectory",
                           [&] { return pathMessage(stamp, map_name, poses_); }));
    if (options_.map.empty())
    {
      return;
    }
    Scan map = readCloud(options_.map);
    map.stamp = stamp;
    map.time.clear();
    map.ring.clear();
    bag_.write({"/map", RosType::point_cloud2, true}, stamp,
               encodedFrom(options_.map, "--no-map leaves it out",
                           [&] { return cloudMessage(map, map_name); }));
  }

  void writeScan(const Frame& frame)
  {
    const Scan& scan = frame.scan;
    const std::vector<bool> moving = movingPoints(frame);
    if (!options_.static_only)
    {
      bag_.write({"/points", RosType::point_cloud2}, scan.stamp,
                 cloudMessage(scan, lidar_name, moving));
    }
    if (!labels_.empty())
    {
      bag_.write({"/points_static", RosType::point_cloud2}, scan.stamp,
                 cloudMessage(scan, lidar_name, moving, MovingPoints::left_out));
    }
    result_.points += scan.size() - (options_.static_only ? static_cast<std::size_t>(std::count(
                                                                moving.begin(), moving.end(), true))
                                                          : 0);
  }

  /** By the labels; empty without. \throws UserError */
  std::vector<bool> movingPoints(const Frame& frame)
  {
    std::vector<bool> moving;
    if (labels_.empty())
    {
      return moving;
    }
    const std::string path = numberedPath(labels_, frame.index, ".label");
    if (!fs::exists(path))
    {
      throw UserError(path + ": no such file, but scan " + std::to_string(frame.index) +
                      " needs its labels; write only scans that have them (" +
                      (result_.scans == 0 ? "--skip-first-n, --only-first-n"
                                          : flagsOfFirst(options_.source, result_.scans)) +
                      "); those of an unfinished run end early, dyslam --resume completes it");
    }
    moving.reserve(frame.scan.size());
    for (const Label label : readLabels(path, frame.scan.size()))
    {
      moving.push_back(isMovingLabel(label));
    }
    ++result_.label_files;
    return moving;
  }

  /** \throws UserError if no scan has a pose. */
  void checkPoses()
  {
    if (result_.poses == 0)
    {
      throw UserError(options_.trajectory + ": has no pose for any scan of " + rawlog_ +
                      "; are they of one recording? " + times());
    }
    if (result_.poses < result_.scans)
    {
      result_.warnings.push_back(options_.trajectory + ": has no pose for " +
                                 std::to_string(result_.scans - result_.poses) + " of " +
                                 counted(result_.scans, "scan") +
                                 ", which are written without a transform and objects " + times());
    }
  }

  /** Those of scans and poses: "(scans: 10.000 to 20.000 s, poses: 5.000 to 6.000 s)". */
  [[nodiscard]] std::string times() const
  {
    return "(scans: " + timesFrom(first_stamp_, last_stamp_) + ", poses: " + timesOf(poses_) + ")";
  }

  const std::string& rawlog_;
  const BagExportOptions& options_;
  Trajectory poses_;  //!< T_map_vehicle
  OdometryMessages odometry_;
  std::string labels_;  //!< folder of the label files; empty: none
  BagOutput bag_;
  std::optional<TrackMarkers> tracks_;
  SampleMessages samples_;
  std::optional<Pose> T_map_world_;  //!< from the frame of the true poses
  double first_stamp_ = 0;           //!< of the scans [s]
  double last_stamp_ = 0;            //!< of the scans so far [s]
  ConversionResult result_;
};
}  // namespace

ConversionResult exportBag(const std::string& rawlog,
                           const std::string& output,
                           const BagExportOptions& options,
                           const ConversionProgress& progress)
{
  validate(options.source, "rawlog2bag");
  requireConsistent(output, options);
  RawlogSourceOptions source_options = options.source;
  source_options.roll = 0;
  source_options.pitch = 0;
  RawlogSource source(rawlog, source_options);
  const fs::path folder = fs::path(output).parent_path();
  if (!folder.empty())
  {
    makeFolder(folder.string(), "choose another --output");
  }
  RecordingBag bag(rawlog, output, options);
  std::size_t count = 0;
  while (const auto frame = nextFrame(source, options.source, count))
  {
    bag.add(*frame);
    ++count;
    if (progress)
    {
      progress(source.progress(), count);
    }
  }
  if (count == 0)
  {
    throw UserError(rawlog + ": " + emptyRange(options.source) + " of the scans");
  }
  ConversionResult result = bag.finish();
  const auto warnings = source.warnings();
  result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  return result;
}
}  // namespace dyslam
