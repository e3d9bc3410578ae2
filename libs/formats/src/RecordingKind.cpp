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

/** Argument of kitti2rawlog's --kind, by what lies beside the scans. */
std::string kittiKind(const fs::path& folder)
{
  if (fs::is_directory(folder / "velodyne_points") || fs::exists(folder / "oxts.txt"))
  {
    return "raw";
  }
  return fs::is_directory(folder / "label_02") || fs::is_directory(folder / "oxts") ? "tracking"
                                                                                    : "odometry";
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

std::string conversionAdvice(const std::string& path)
{
  if (isBag(path))
  {
    return "is a ROS bag" + firstMake("scans2rawlog", path);
  }
  const std::string ending = lowerExtension(path);
  if (ending == ".pcap" || ending == ".pcapng")
  {
    return "is a network capture" + firstMake("scans2rawlog", path);
  }
  if (!fs::is_directory(path))
  {
    return "";
  }
  if (isKittiFolder(path))
  {
    return "is a KITTI recording" + firstMake("kitti2rawlog --kind " + kittiKind(path), path) +
           " (--kind is raw, odometry or tracking)";
  }
  if (hasFile(path, isCloudFile))
  {
    return "is a folder of scans" + firstMake("scans2rawlog", path);
  }
  return "is a folder, a file is needed: kitti2rawlog makes a rawlog of a KITTI recording, "
         "scans2rawlog of a folder of scans";
}
}  // namespace dyslam
