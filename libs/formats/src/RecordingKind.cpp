// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

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

bool isKittiScan(const std::string& path)
{
  return fs::path(path).extension() == ".bin";
}

bool isFolder(const std::string& path)
{
  return fs::is_directory(path);
}

bool isNumberedFolder(const std::string& path)
{
  return isFolder(path) && numberOfName(fs::path(path).filename().string(), "").has_value();
}

/** Whether a drive of this name is one of KITTI-360, all of which were recorded in one day. KITTI
 * raw has the same folders, and no drive of that day. */
bool isDriveOfKitti360(const std::string& name)
{
  return name.rfind("2013_05_28_drive_", 0) == 0;
}

std::string firstMake(const std::string& program, const std::string& path)
{
  fs::path name = fs::path(path).lexically_normal();
  name = name.has_filename() ? name : name.parent_path();
  return "; make a rawlog of it first: " + program + " -i " + shellWord(path) + " -o " +
         shellWord(name.stem().string() + ".rawlog");
}
}  // namespace

std::string toString(KittiKind kind)
{
  switch (kind)
  {
    case KittiKind::odometry:
      return "odometry";
    case KittiKind::raw:
      return "raw";
    case KittiKind::tracking:
      return "tracking";
    case KittiKind::kitti360:
      break;
  }
  return "360";
}

std::optional<KittiKind> officialKittiKind(const std::string& folder)
{
  // A relative path need not have the folder's parent in it.
  const fs::path path = fs::absolute(fs::path(folder) / "").lexically_normal().parent_path();
  if (hasFile(path / "velodyne_points" / "data", isKittiScan))
  {
    return isDriveOfKitti360(path.filename().string()) ? KittiKind::kitti360 : KittiKind::raw;
  }
  if (hasFile(path / "velodyne", isKittiScan))
  {
    return path.parent_path().filename() == "sequences" ? std::optional(KittiKind::odometry)
                                                        : std::nullopt;
  }
  return hasFile(path / "velodyne", isNumberedFolder) ? std::optional(KittiKind::tracking)
                                                      : std::nullopt;
}

std::optional<KittiKind> kittiKindOf(const std::string& folder)
{
  if (const auto official = officialKittiKind(folder))
  {
    return official;
  }
  const fs::path path(folder);
  const fs::path velodyne = path / "velodyne";
  const bool has_raw_folder = fs::is_directory(path / "velodyne_points");
  if (!has_raw_folder && !fs::is_directory(velodyne))
  {
    return std::nullopt;
  }
  if (!has_raw_folder && hasFile(velodyne, isCloudFile) && !hasFile(velodyne, isKittiScan))
  {
    return std::nullopt;  // KITTI has .bin only
  }
  if (has_raw_folder || fs::exists(path / "oxts.txt"))
  {
    return KittiKind::raw;
  }
  const bool has_sequences = !hasFile(velodyne, isCloudFile) && hasFile(velodyne, isFolder);
  return has_sequences || fs::is_directory(path / "label_02") || fs::is_directory(path / "oxts")
             ? KittiKind::tracking
             : KittiKind::odometry;
}

std::string bagEnding(const std::string& path)
{
  if (!unpackCommand(path).empty())
  {
    return bagEnding(fs::path(path).stem().string());
  }
  const std::string ending = lowerExtension(path);
  const bool is_open = ending == ".active" && lowerExtension(fs::path(path).stem()) == ".bag";
  return is_open ? ".bag" : ending;
}

bool isBagFile(const std::string& path)
{
  const std::string ending = bagEnding(path);
  return ending == ".bag" || ending == ".db3" || ending == ".mcap";
}

std::string unpackCommand(const std::string& path)
{
  const std::string ending = lowerExtension(path);
  return ending == ".zstd" || ending == ".zst" ? "zstd -d"
         : ending == ".gz"                     ? "gunzip -k"
         : ending == ".bz2"                    ? "bunzip2 -k"
         : ending == ".xz"                     ? "unxz -k"
                                               : "";
}

bool isPackedBag(const std::string& path)
{
  return !unpackCommand(path).empty() && isBagFile(path);
}

bool isBag(const std::string& path)
{
  return fs::is_directory(path) ? hasFile(path, isBagFile) && !hasFile(path, isCloudFile)
                                : isBagFile(path);
}

bool isNetworkInput(const std::string& input)
{
  return input.rfind("udp:", 0) == 0;
}

bool isRos2Input(const std::string& input)
{
  return input.rfind("ros2:", 0) == 0;
}

bool isLiveInput(const std::string& input)
{
  return isNetworkInput(input) || isRos2Input(input);
}

RecordingKind recordingKind(const std::string& path)
{
  if (isNetworkInput(path))
  {
    return RecordingKind::network;
  }
  if (isRos2Input(path))
  {
    return RecordingKind::topics;
  }
  if (isBag(path))
  {
    return RecordingKind::bag;
  }
  if (fs::is_directory(path))
  {
    return kittiKindOf(path)            ? RecordingKind::kitti
           : hasFile(path, isCloudFile) ? RecordingKind::scans
                                        : RecordingKind::unknown;
  }
  const std::string ending =
      lowerExtension(unpackCommand(path).empty() ? path : fs::path(path).stem().string());
  return ending == ".pcap" || ending == ".pcapng" ? RecordingKind::capture : RecordingKind::unknown;
}

std::string conversionAdvice(const std::string& path)
{
  if (lowerExtension(path) == ".osf")
  {
    return "is a recording of Ouster's SDK, whose own format is not read; save its packets: "
           "ouster-cli source " +
           path + " save " + fs::path(path).stem().string() + ".pcap";
  }
  std::error_code no_run;
  if (fs::is_regular_file(fs::path(path) / run_files::report, no_run))  // its clouds are maps
  {
    return "is the output folder of a run, a file is needed; its recording is \"input\" in its "
           "report.json";
  }
  switch (recordingKind(path))
  {
    case RecordingKind::bag:
      return "is a ROS bag" + firstMake("scans2rawlog", path);
    case RecordingKind::capture:
      return "is a network capture" + firstMake("scans2rawlog", path);
    case RecordingKind::network:
      return "is a lidar on the network; record it first: scans2rawlog -i " + shellWord(path) +
             " -o drive.rawlog";
    case RecordingKind::topics:
      return "is live; record it first: scans2rawlog -i " + path + " -o drive.rawlog";
    case RecordingKind::scans:
      return "is a folder of scans" + firstMake("scans2rawlog", path);
    case RecordingKind::kitti:
      return "is a KITTI recording" +
             firstMake("kitti2rawlog --kind " + toString(kittiKindOf(path).value()), path) +
             " (--kind is raw, odometry, tracking or 360)";
    case RecordingKind::unknown:
      break;
  }
  return fs::is_directory(path)
             ? "is a folder, a file is needed: kitti2rawlog makes a rawlog of a KITTI recording, "
               "scans2rawlog of a folder of scans"
             : "";
}
}  // namespace dyslam
