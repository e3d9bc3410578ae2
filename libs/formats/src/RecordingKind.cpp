// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
bool hasFile(const fs::path& folder, bool (*wanted)(const std::string&))
{
  std::error_code unreadable;
  const auto files = fs::directory_iterator(folder, unreadable);
  return !unreadable &&
         std::any_of(begin(files), end(files),
                     [wanted](const auto& entry) { return wanted(entry.path().string()); });
}

bool isKittiFolder(const fs::path& folder)
{
  return fs::is_directory(folder / "velodyne") || fs::is_directory(folder / "velodyne_points");
}

/** By the official layouts, then by what lies beside the scans. */
RecordingKind kittiKind(const fs::path& folder)
{
  if (fs::is_directory(folder / "velodyne_points"))
  {
    return RecordingKind::kitti_raw;
  }
  if (!hasFile(folder / "velodyne", isCloudFile) &&
      hasFile(folder / "velodyne", [](const std::string& path) { return fs::is_directory(path); }))
  {
    return RecordingKind::kitti_tracking;  // a folder for each sequence
  }
  const fs::path path = fs::absolute(folder / "").lexically_normal().parent_path();
  if (path.parent_path().filename() == "sequences")
  {
    return RecordingKind::kitti_odometry;
  }
  if (fs::exists(folder / "oxts.txt"))
  {
    return RecordingKind::kitti_raw;
  }
  return fs::is_directory(folder / "label_02") || fs::is_directory(folder / "oxts")
             ? RecordingKind::kitti_tracking
             : RecordingKind::kitti_odometry;
}

/** Argument of kitti2rawlog's --kind; empty for a recording that is no KITTI folder. */
std::string kittiWord(RecordingKind kind)
{
  return kind == RecordingKind::kitti_odometry   ? "odometry"
         : kind == RecordingKind::kitti_raw      ? "raw"
         : kind == RecordingKind::kitti_tracking ? "tracking"
                                                 : "";
}

std::string firstMake(const std::string& program, const std::string& path)
{
  fs::path name = fs::path(path).lexically_normal();
  name = name.has_filename() ? name : name.parent_path();
  return "; make a rawlog of it first: " + program + " -i " + path + " -o " + name.stem().string() +
         ".rawlog";
}
}  // namespace

bool isBagFile(const std::string& path)
{
  const std::string ending = lowerExtension(path);
  return ending == ".bag" || ending == ".db3" || ending == ".mcap" || isPackedBag(path);
}

bool isPackedBag(const std::string& path)
{
  return lowerExtension(path) == ".zstd" && fs::path(path).stem().has_extension() &&
         isBagFile(fs::path(path).stem().string());
}

bool isBag(const std::string& path)
{
  return fs::is_directory(path) ? hasFile(path, isBagFile) && !hasFile(path, isCloudFile)
                                : isBagFile(path);
}

RecordingKind recordingKind(const std::string& path)
{
  if (isBag(path))
  {
    return RecordingKind::bag;
  }
  if (fs::is_directory(path))
  {
    return isKittiFolder(path)          ? kittiKind(path)
           : hasFile(path, isCloudFile) ? RecordingKind::scans
                                        : RecordingKind::unknown;
  }
  const std::string ending = lowerExtension(path);
  return ending == ".pcap" || ending == ".pcapng" ? RecordingKind::capture : RecordingKind::unknown;
}

std::string conversionAdvice(const std::string& path)
{
  const RecordingKind kind = recordingKind(path);
  switch (kind)
  {
    case RecordingKind::bag:
      return "is a ROS bag" + firstMake("scans2rawlog", path);
    case RecordingKind::capture:
      return "is a network capture" + firstMake("scans2rawlog", path);
    case RecordingKind::scans:
      return "is a folder of scans" + firstMake("scans2rawlog", path);
    case RecordingKind::kitti_odometry:
    case RecordingKind::kitti_raw:
    case RecordingKind::kitti_tracking:
      return "is a KITTI recording" + firstMake("kitti2rawlog --kind " + kittiWord(kind), path) +
             " (--kind is raw, odometry or tracking)";
    case RecordingKind::unknown:
      break;
  }
  return fs::is_directory(path)
             ? "is a folder, a file is needed: kitti2rawlog makes a rawlog of a KITTI recording, "
               "scans2rawlog of a folder of scans"
             : "";
}
}  // namespace dyslam
