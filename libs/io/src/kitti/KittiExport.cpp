// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/PointTimeFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/formats/TrackFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/KittiExport.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "KittiDeskewing.h"
#include "KittiSequenceFiles.h"
#include "conversion/ConversionOutput.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
constexpr double same_instant = 1e-3;  //!< [s] between a scan and its pose in a TUM file

/** Whether it is a calib.txt of KITTI odometry. */
bool isOdometryCalib(const std::string& path)
{
  if (!fs::is_regular_file(path))
  {
    return false;
  }
  TextFile file(path, " \t\r:");
  while (file.next())
  {
    if (file.fields().front() == "Tr")
    {
      return true;
    }
  }
  return false;
}

/** `key: `, then the upper three rows of a matrix. */
template <typename Matrix>
void appendRows(std::string& text, const std::string& key, const Matrix& matrix)
{
  text += key + ':';
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 4; ++column)
    {
      text += ' ';
      appendNumber(text, matrix(row, column), 12);
    }
  }
  text += '\n';
}

/** The calibration of a camera at the origin of the lidar that looks forward. */
KittiCalib calibAtLidar()
{
  KittiCalib calib;
  calib.T_cam_velo = cameraAxes();
  return calib;
}

/** One sequence while it is written; removed with the object unless finish() was called. */
class Sequence
{
 public:
  Sequence(const std::string& rawlog, const std::string& folder, const KittiExportOptions& options)
      : options_(options),
        target_(folder, options),
        pending_(target_.sequence()),
        truth_(groundTruthFolder(rawlog))
  {
    if (!options.trajectory.empty())
    {
      given_ = readTrajectory(options.trajectory);
      if (given_->format == TrajectoryFormat::kitti &&
          (options.skip_first_n > 0 || options.start > 0))
      {
        throw UserError(options.trajectory +
                        ": has no times, so its lines cannot be assigned with " +
                        (options.skip_first_n > 0 ? "--skip-first-n" : "--start") +
                        "; give the TUM file of the run");
      }
    }
    if (!options.calib.empty())
    {
      calib_ = readKittiCalib(options.calib);
      if (!calib_.has_camera)
      {
        throw UserError(options.calib +
                        ": has no calib_cam_to_cam.txt and calib_velo_to_cam.txt, needed for the "
                        "poses of the camera");
      }
    }
    if (!options.tracks.empty())
    {
      for (LabelledBox& box : readTracks(options.tracks))
      {
        tracks_[box.frame].push_back(std::move(box));
      }
    }
    if (!options.poses_only)
    {
      target_.beginSequence();
      makeFolder((pending_ / "velodyne").string());
    }
  }

  void add(const Frame& frame)
  {
    const Scan& scan = frame.scan;
    const std::optional<Pose> T_world_vehicle = poseOf(frame);
    if (!options_.no_scans && !options_.poses_only)
    {
      writeScan(frame, T_world_vehicle);
    }
    first_stamp_ = result_.scans == 0 ? scan.stamp : first_stamp_;
    appendFixed(times_, scan.stamp - first_stamp_, 9);
    times_ += '\n';
    if (T_world_vehicle)
    {
      poses_.push_back(*T_world_vehicle * scan.T_vehicle_lidar);
    }
    addTracks(static_cast<int>(frame.index));
    ++result_.scans;
    result_.points += scan.size();
  }

  ConversionResult finish()
  {
    const bool poses = !poses_.empty() && poses_.size() == result_.scans;
    if (poses && linesLeft() > 0)
    {
      result_.warnings.push_back(options_.trajectory + ": has " +
                                 counted(given_->trajectory.size(), "pose") + " for " +
                                 counted(result_.scans, "scan") +
                                 "; without times the first ones are used: give the TUM file of "
                                 "the run if they are not of these scans");
    }
    if (poses)
    {
      result_.poses = poses_.size();
      result_.pose_source = options_.trajectory.empty() ? "the rawlog" : options_.trajectory;
    }
    if (!options_.poses_only)
    {
      writeSequence(poses);
    }
    else if (!poses)
    {
      throw UserError("--poses-only: " + missingPoses());
    }
    if (poses)
    {
      writeKittiPoses(target_.beginPoses(), cameraPoses());
    }
    target_.install();
    return result_;
  }

 private:
  [[nodiscard]] std::string missingPoses() const
  {
    return "no poses are written: " + std::to_string(poses_.size()) + " of " +
           counted(result_.scans, "scan") + " have one";
  }

  /** Writes the folder of the sequence. \param poses whether every scan has a pose */
  void writeSequence(bool poses)
  {
    deskewing_.finish();
    writeWhole((pending_ / "times.txt").string(), times_);
    writeCalib();
    if (poses)
    {
      writeKittiPoses((pending_ / "poses.txt").string(), cameraPoses());
    }
    else
    {
      result_.warnings.push_back(missingPoses());
    }
    if (options_.rings && ring_files_ < result_.scans)
    {
      result_.warnings.push_back("--rings: " + std::to_string(ring_files_) + " of " +
                                 std::to_string(result_.scans) +
                                 " scans have ring numbers; the others have no .ring");
    }
    if (options_.no_scans)
    {
      fs::remove(pending_ / "velodyne");
    }
    noteDeskewing();
    writeTracksOfScans();
  }

  /** Takes the boxes of a scan. \param index of the scan in the recording */
  void addTracks(int index)
  {
    const auto boxes = tracks_.find(index);
    if (boxes != tracks_.end())
    {
      for (LabelledBox& box : boxes->second)
      {
        box.frame = static_cast<int>(result_.scans);
        written_tracks_.push_back(std::move(box));
      }
      boxes->second.clear();
    }
  }

  void writeTracksOfScans()
  {
    if (options_.tracks.empty())
    {
      return;
    }
    if (written_tracks_.empty())
    {
      result_.warnings.push_back(options_.tracks + ": has no box of these scans");
    }
    writeKittiTracks(target_.beginTracks(), written_tracks_, calib_.T_cam_velo);
  }

  /** Writes the points, deskewed with --deskew, otherwise as recorded and with their times. */
  void writePoints(const Frame& frame, const std::optional<Pose>& T_world_vehicle)
  {
    const Scan& scan = frame.scan;
    const std::string file = numberedPath((pending_ / "velodyne").string(), result_.scans, ".bin");
    if (options_.deskew)
    {
      if (!T_world_vehicle)
      {
        throw UserError("--deskew: scan " + std::to_string(frame.index) +
                        " has no pose; give poses of all scans with --trajectory");
      }
      deskewing_.add(scan, *T_world_vehicle * scan.T_vehicle_lidar, file);
      return;
    }
    writeBin(file, scan.points, scan.intensity);
    untimed_ = untimed_ || scan.time.empty();
    if (isSwept(scan))
    {
      makeFolder((pending_ / point_time_folder).string());
      writePointTimes(
          (pending_ / point_time_folder / numberedName(result_.scans, ".time")).string(),
          scan.time);
      swept_ = true;
    }
  }

  void noteDeskewing()
  {
    if (swept_)
    {
      result_.notes.push_back(
          "the scans are as recorded, not deskewed as those of KITTI odometry are (--deskew), so "
          "other programs may take them for such; dyslam deskews them by the times in " +
          std::string(point_time_folder));
    }
    else if (untimed_)
    {
      result_.notes.emplace_back(
          "the points have no times, so dyslam takes the scans for deskewed, as those of KITTI "
          "odometry are; if they are not: dyslam --deskewed no");
    }
    if (deskewing_.withoutTimes() > 0)
    {
      result_.warnings.push_back(
          "--deskew: the points of " + std::to_string(deskewing_.withoutTimes()) + " of " +
          counted(result_.scans, "scan") + " have no times: these scans are as recorded");
    }
  }

  void writeScan(const Frame& frame, const std::optional<Pose>& T_world_vehicle)
  {
    const Scan& scan = frame.scan;
    const fs::path velodyne = pending_ / "velodyne";
    writePoints(frame, T_world_vehicle);
    if (options_.rings && !scan.ring.empty())
    {
      std::string rings;
      for (const std::uint16_t ring : scan.ring)
      {
        rings += static_cast<char>(std::min<std::uint16_t>(ring, 255));
      }
      writeWhole((velodyne / numberedName(result_.scans, ".ring")).string(), rings);
      ++ring_files_;
    }
    if (const auto labels = trueLabels(truth_, frame.index, scan.size()))
    {
      makeFolder((pending_ / "labels").string());
      writeLabels((pending_ / "labels" / numberedName(result_.scans, ".label")).string(), *labels);
      ++result_.label_files;
    }
  }

  [[nodiscard]] std::optional<Pose> poseOf(const Frame& frame) const
  {
    if (!given_)
    {
      return frame.T_world_vehicle_truth;
    }
    const Trajectory& poses = given_->trajectory;
    if (given_->format == TrajectoryFormat::kitti)
    {
      return result_.scans < poses.size() ? std::optional<Pose>(poses[result_.scans].pose)
                                          : std::nullopt;
    }
    const auto nearest = poses.nearest(frame.scan.stamp, same_instant);
    return nearest ? std::optional<Pose>(poses[*nearest].pose) : std::nullopt;
  }

  /** Lines of a trajectory without times beyond the scans of the whole recording. */
  [[nodiscard]] std::size_t linesLeft() const
  {
    const bool whole = options_.only_first_n == 0 && options_.end <= 0;
    return given_ && given_->format == TrajectoryFormat::kitti && whole
               ? given_->trajectory.size() - result_.scans
               : 0;
  }

  /** Of camera 0 in its own first frame. */
  [[nodiscard]] std::vector<Pose> cameraPoses() const
  {
    std::vector<Pose> poses;
    for (const Pose& pose : poses_)
    {
      poses.push_back(orthonormalised(poses_.front().inverse() * pose));
    }
    return posesOfMountedSensor(poses, calib_.T_cam_velo.inverse());
  }

  void writeCalib() const
  {
    const std::string file = (pending_ / "calib.txt").string();
    if (isOdometryCalib(options_.calib))
    {
      fs::copy_file(options_.calib, file);
      return;
    }
    const Eigen::Matrix<double, 3, 4> no_projection = Eigen::Matrix<double, 3, 4>::Identity();
    std::string text;
    appendRows(text, "P0", no_projection);
    appendRows(text, "P1", no_projection);
    appendRows(text, "P2", calib_.P2.isZero() ? no_projection : calib_.P2);
    appendRows(text, "P3", no_projection);
    appendRows(text, "Tr", calib_.T_cam_velo.matrix());
    writeWhole(file, text);
  }

  const KittiExportOptions& options_;
  KittiSequenceFiles target_;
  fs::path pending_;   //!< folder of the sequence until the end
  std::string truth_;  //!< folder of the rawlog's ground truth, which may not be there
  std::optional<TrajectoryFile> given_;
  KittiCalib calib_ = calibAtLidar();
  std::string times_;
  double first_stamp_ = 0;
  std::size_t ring_files_ = 0;
  KittiDeskewing deskewing_;                        //!< with --deskew
  bool swept_ = false;                              //!< some scan has times beside it
  bool untimed_ = false;                            //!< some scan is written without times
  std::vector<Pose> poses_;                         //!< T_world_lidar
  std::map<int, std::vector<LabelledBox>> tracks_;  //!< by number of the scan in the recording
  std::vector<LabelledBox> written_tracks_;         //!< by number of the scan in the sequence
  ConversionResult result_;
};
}  // namespace

void KittiExportOptions::describe(OptionsVisitor& visitor)
{
  visitor.text("sequence", sequence, "name of the sequence's folder");
  visitor.text("trajectory", trajectory,
               "file of TUM or KITTI poses of the vehicle; empty: ground truth");
  visitor.text("calib", calib, "calibration file or folder; empty: camera axes at the lidar");
  visitor.text("tracks", tracks,
               "tracks.txt of a run, to be written in the camera frame; empty: none");
  visitor.text("sensor_label", sensor_label,
               "regex for the lidar's sensor label; empty: the first");
  visitor.text("further_lidars", further_lidars,
               "regex for the labels of further lidars, whose scans are merged; empty: none");
  visitor.flag("no_scans", no_scans, "write only times, calibration and poses");
  visitor.flag("deskew", deskew, "deskew the scans to their stamps along the poses");
  visitor.flag("poses_only", poses_only, "write only poses/NN.txt");
  visitor.flag("force", force, "replace an earlier export of the sequence");
  visitor.flag("rings", rings, "write NNNNNN.ring beside the scans");
  describeRange(visitor);
}

ConversionResult exportKitti(const std::string& rawlog,
                             const std::string& folder,
                             const KittiExportOptions& options,
                             const ConversionProgress& progress)
{
  validate(options, "rawlog2kitti");
  if (options.sequence.empty() || options.sequence.find('/') != std::string::npos)
  {
    throw UserError("--sequence '" + options.sequence + "': is not a valid folder name");
  }
  if (options.rings && !options.further_lidars.empty())
  {
    throw UserError(
        "--rings: rings of several lidars are no numbers of one; leave out "
        "--further-lidars");
  }
  if (options.rings && options.no_scans)
  {
    throw UserError("--rings: are written beside the scans; leave out --no-scans");
  }
  if (options.deskew && (options.no_scans || options.poses_only))
  {
    throw UserError("--deskew: is for the scans; leave out --no-scans and --poses-only");
  }
  if (options.poses_only && (options.rings || options.no_scans || !options.tracks.empty()))
  {
    throw UserError(
        "--poses-only: writes poses/NN.txt alone; leave out --no-scans, --rings and --tracks");
  }
  RawlogSourceOptions source_options;
  static_cast<ScanRange&>(source_options) = options;
  source_options.sensor_label = options.sensor_label;
  source_options.further_lidars = options.further_lidars;
  RawlogSource source(rawlog, source_options);
  Sequence sequence(rawlog, folder, options);
  std::size_t count = 0;
  while (const auto frame = source.next())
  {
    sequence.add(*frame);
    ++count;
    if (progress)
    {
      progress(source.progress(), count);
    }
  }
  if (count == 0)
  {
    throw UserError(rawlog + ": " + emptyRange(options) + " of the scans");
  }
  ConversionResult result = sequence.finish();
  const auto warnings = source.warnings();
  result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
  return result;
}
}  // namespace dyslam
