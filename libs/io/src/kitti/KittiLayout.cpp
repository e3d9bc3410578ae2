// SPDX-License-Identifier: BSD-3-Clause
#include "KittiLayout.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Trajectory.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <utility>

#include "KittiBoxes.h"
#include "KittiCalibFinder.h"
#include "KittiOxts.h"
#include "KittiScans.h"
#include "KittiTimes.h"
#include "conversion/ConversionOutput.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** The folder of the recording without a slash at its end. \throws UserError if it is none. */
fs::path recordingFolder(const std::string& input)
{
  if (isBag(input))
  {
    throw UserError(input + ": " + conversionAdvice(input));
  }
  if (!fs::is_directory(input))
  {
    throw UserError(input + ": no such folder");
  }
  const fs::path folder = fs::path(input).lexically_normal();
  return folder.has_filename() ? folder : folder.parent_path();
}

/** The calibration of KITTI-360 is for the axes of its poses (y right, z down); those of the
 * readings in its oxts may be others. \throws UserError for options that need them. */
void requireUsableOxts(const KittiConverterOptions& options)
{
  const char* const flag = !options.oxts.empty() ? "--oxts"
                           : options.imu         ? "--imu"
                           : options.gnss        ? "--gnss"
                                                 : nullptr;
  if (options.kind == KittiKind::kitti360 && flag != nullptr)
  {
    throw UserError(std::string(flag) + ": the oxts of KITTI-360 are not read; leave it out");
  }
}

/** Gathers one layout; each method finds one kind of file. */
class LayoutReader
{
 public:
  LayoutReader(KittiScans scans, const KittiConverterOptions& options)
      : input_(scans.folder),
        options_(options),
        sequence_(scans.sequence),
        calib_(scans.folder, scans.sequence, options)
  {
    layout_.entries = std::move(scans.entries);
  }

  KittiLayout read()
  {
    if (officialKittiKind(input_.string()) == KittiKind::odometry)
    {
      noteCameraPoses();
    }
    times_ = readKittiTimes(input_, sequence_, options_, layout_);
    if (!options_.calib.empty())
    {
      calib_.read();
    }
    if (options_.deskewed != ScansDeskewed::yes)
    {
      findPointTimes(input_, layout_);
    }
    if (!options_.no_truth)
    {
      findLabels();
      readTruth("poses", !options_.poses.empty() || !options_.oxts.empty(),
                [this] { readPoses(); });
      readTruth("boxes", !options_.boxes.empty(), [this] { readBoxes(); });
    }
    if (options_.imu || options_.gnss)
    {
      readSamples(options_.imu ? "--imu" : "--gnss");
    }
    else
    {
      layout_.has_unused_oxts = !findOxts(input_, sequence_, options_).empty();
    }
    return std::move(layout_);
  }

 private:
  /** Says, once, which poses of a run are those of the camera, as the recording's are. */
  void noteCameraPoses()
  {
    if (!std::exchange(noted_camera_, true))
    {
      layout_.notes.emplace_back(
          "trajectory_kitti.txt of a run has poses of the lidar (x ahead), KITTI's are of camera 0 "
          "(z ahead): rawlog2kitti --trajectory writes such, dyslam-eval trajectory compares "
          "both");
    }
  }

  /** Reads one kind of ground truth. If that was found but not requested, an error is a warning. */
  void readTruth(const char* what, bool requested, const std::function<void()>& read)
  {
    try
    {
      read();
    }
    catch (const UserError& error)
    {
      if (requested || !options_.calib.empty())
      {
        throw;
      }
      layout_.warnings.push_back("converted without true " + std::string(what) + ": " +
                                 error.what());
    }
  }

  void findLabels()
  {
    const std::string folder = firstExisting(
        options_.labels, {input_ / "labels", fs::path(layout_.entries.front().scan).parent_path()});
    if (folder.empty())
    {
      return;
    }
    std::size_t found = 0;
    for (auto& entry : layout_.entries)
    {
      const fs::path file = fs::path(folder) / (fs::path(entry.scan).stem().string() + ".label");
      if (fs::exists(file))
      {
        entry.labels = file.string();
        ++found;
      }
    }
    if (found == 0 && !options_.labels.empty())
    {
      throw UserError(folder + ": has no .label file named as a scan, such as " +
                      fs::path(layout_.entries.front().scan).stem().string() + ".label");
    }
    if (found > 0 && found < layout_.entries.size())
    {
      layout_.warnings.push_back(folder + ": labels for " + std::to_string(found) + " of " +
                                 std::to_string(layout_.entries.size()) + " scans");
    }
  }

  /** Files of true poses that the layout may have. */
  [[nodiscard]] std::vector<fs::path> poseFiles() const
  {
    std::vector<fs::path> files{input_ / "poses.txt"};
    const std::string name = nameOfFile(input_);
    const fs::path above = folderAbove(input_);
    const fs::path dataset = folderAbove(above);
    if (options_.kind == KittiKind::odometry)
    {
      files.push_back((dataset / "poses" / (name + ".txt")).lexically_normal());
    }
    if (options_.kind == KittiKind::kitti360)
    {
      for (const fs::path& folder : {dataset, above})
      {
        files.push_back((folder / "data_poses" / name / "poses.txt").lexically_normal());
      }
    }
    return files;
  }

  void readPoses()
  {
    const std::string path = firstExisting(options_.poses, poseFiles());
    if (path.empty())
    {
      readOxtsPoses();
      if (options_.kind == KittiKind::odometry && layout_.pose_file.empty())
      {
        layout_.notes.push_back("no true poses: the recording has neither " +
                                poseFiles()[0].string() + " nor " + poseFiles()[1].string() +
                                "; --poses of kitti2rawlog names another file");
      }
      if (options_.kind == KittiKind::kitti360)
      {
        layout_.warnings.push_back("converted without true poses: no " + poseFiles()[1].string() +
                                   "; name another file with --poses of kitti2rawlog");
      }
      return;
    }
    if (options_.kind == KittiKind::kitti360 && hasKitti360Poses(path))
    {
      assignByFrame(path, readKitti360Poses(path));
      setPoseSource(PoseSource::given, path, ": KITTI-360 has none where the car hardly moved");
      return;
    }
    const TrajectoryFile file = readTrajectory(path);
    std::vector<Pose> poses;
    for (const StampedPose& pose : file.trajectory)
    {
      poses.push_back(pose.pose);
    }
    if (isCameraFrame(path, file.format))
    {
      poses = posesOfMountedSensor(poses, calib_.requireCamera("poses of the camera"));
      noteCameraPoses();
    }
    if (file.format == TrajectoryFormat::tum && times_ != KittiTimes::assumed)
    {
      Trajectory of_lidar;
      for (std::size_t i = 0; i < poses.size(); ++i)
      {
        of_lidar.push_back(file.trajectory[i].stamp, poses[i]);
      }
      for (auto& entry : layout_.entries)
      {
        entry.T_world_lidar = truePoseAt(of_lidar, entry.stamp);
      }
    }
    else
    {
      if (file.format == TrajectoryFormat::tum)
      {
        checkPoseCount(path, poses.size());
      }
      assign(path, poses);
    }
    setPoseSource(PoseSource::given, path);
  }

  /** Poses with times, of scans without, may be of another rate: warns if there are more of them.
   * \throws UserError if there are fewer. */
  void checkPoseCount(const std::string& path, std::size_t poses)
  {
    const std::size_t scans = layout_.entries.size();
    const std::string counts = path + ": has poses at " + counted(poses, "time") +
                               ", but there are " + counted(scans, "scan") + " without times";
    if (poses < scans)
    {
      throw UserError(counts + "; give --times");
    }
    if (poses > scans)
    {
      layout_.warnings.push_back(
          counts +
          ": each has the pose in the line of its number; give --times unless there is "
          "a pose for each");
    }
  }

  [[nodiscard]] bool isCameraFrame(const std::string& path, TrajectoryFormat format) const
  {
    if (options_.pose_frame != PoseFrame::automatic)
    {
      return options_.pose_frame == PoseFrame::camera;
    }
    const std::string name = fs::path(path).filename().string();
    return options_.kind == KittiKind::odometry && format == TrajectoryFormat::kitti &&
           name.find("velo") == std::string::npos && name.find("lidar") == std::string::npos;
  }

  /** Poses of KITTI-360, with the calibration of the sensor that they are of. */
  void assignByFrame(const std::string& path, const Kitti360Poses& poses)
  {
    Pose T_sensor_lidar = Pose::Identity();
    if (options_.pose_frame == PoseFrame::camera ||
        (options_.pose_frame == PoseFrame::automatic && poses.are_of_camera))
    {
      T_sensor_lidar = calib_.requireCamera("poses of the camera");
    }
    else if (options_.pose_frame == PoseFrame::automatic)
    {
      T_sensor_lidar = calib_.requireImu("poses of the IMU").inverse();
    }
    std::size_t found = 0;
    for (auto& entry : layout_.entries)
    {
      const auto pose = poses.of_frame.find(static_cast<int>(entry.number));
      if (pose != poses.of_frame.end())
      {
        entry.T_world_lidar = pose->second * T_sensor_lidar;
        ++found;
      }
    }
    if (found == 0)
    {
      throw UserError(
          path + ": has poses of frames " + std::to_string(poses.of_frame.begin()->first) + " to " +
          std::to_string(poses.of_frame.rbegin()->first) + ", none of the scans " +
          std::to_string(layout_.entries.front().number) + " to " +
          std::to_string(layout_.entries.back().number) + "; give those of the same drive");
    }
  }

  void readOxtsPoses()
  {
    const std::string path = findOxts(input_, sequence_, options_);
    if (path.empty())
    {
      return;
    }
    const Pose& T_velo_imu = calib_.requireImu("poses of oxts");
    assign(path, posesOfMountedSensor(oxtsPoses(readOxts(path)), T_velo_imu.inverse()));
    setPoseSource(PoseSource::gnss_ins, path);
  }

  /** \param flag that wants samples of oxts */
  void readSamples(const char* flag)
  {
    const std::string path = findOxts(input_, sequence_, options_);
    if (path.empty())
    {
      throw UserError(input_.string() + ": has no oxts, which is needed for " + flag +
                      "; name it with --oxts");
    }
    readOxtsSamples(path, calib_.requireImu(flag), times_, options_, layout_);
  }

  void assign(const std::string& path, const std::vector<Pose>& poses)
  {
    const std::vector<std::size_t> lines =
        linesOfScans(layout_.entries, path, poses.size(), "pose");
    for (std::size_t i = 0; i < lines.size(); ++i)
    {
      if (lines[i] < poses.size())
      {
        layout_.entries[i].T_world_lidar = poses[lines[i]];
      }
    }
  }

  /** \param why_missing reason for scans without a pose, for the warning */
  void setPoseSource(PoseSource source,
                     const std::string& path,
                     const std::string& why_missing = "")
  {
    layout_.pose_file = path;
    const bool is_given = options_.pose_source != PoseSource::unknown;
    layout_.pose_origin = {is_given ? options_.pose_source : source, nameOfFile(path)};
    warnAboutMissing(path, why_missing);
  }

  void warnAboutMissing(const std::string& path, const std::string& why)
  {
    const auto missing =
        std::count_if(layout_.entries.begin(), layout_.entries.end(),
                      [](const auto& entry) { return !entry.T_world_lidar.has_value(); });
    if (missing > 0)
    {
      layout_.warnings.push_back(path + ": has no pose for " + std::to_string(missing) + " of " +
                                 std::to_string(layout_.entries.size()) + " scans" + why);
    }
  }

  void readBoxes()
  {
    std::vector<fs::path> candidates{input_ / "label_02.txt", input_ / "label_json"};
    if (!sequence_.empty())
    {
      candidates.insert(candidates.begin(), input_ / "label_02" / (sequence_ + ".txt"));
    }
    const std::string path = firstExisting(options_.boxes, candidates);
    if (path.empty())
    {
      return;
    }
    if (!fs::is_directory(path))
    {
      layout_.boxes = readKittiTracking(path, calib_.requireCamera("boxes of the camera"));
      return;
    }
    layout_.boxes = readBoxFolder(path, layout_.entries);
    if (layout_.boxes.empty() && !options_.boxes.empty())
    {
      throw UserError(path + ": has no .json boxes named as a scan");
    }
    assignMissingIds(path, layout_.boxes, layout_.warnings);
  }

  fs::path input_;
  const KittiConverterOptions& options_;
  std::string sequence_;
  KittiCalibFinder calib_;
  KittiLayout layout_;
  KittiTimes times_ = KittiTimes::assumed;
  bool noted_camera_ = false;  //!< noteCameraPoses() was called
};
}  // namespace

KittiLayout readKittiLayout(const std::string& input, const KittiConverterOptions& options)
{
  const fs::path folder = recordingFolder(input);
  requireUsableOxts(options);
  return LayoutReader(findKittiScans(folder, options), options).read();
}
}  // namespace dyslam
