// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/KittiConverter.h>
#include <dyslam/io/RecordingConverter.h>
#include <dyslam/io/ScanConverter.h>

#include <filesystem>
#include <vector>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** A file that is no rawlog and about which convertScans() says what to give instead. */
bool isPartOfRecording(const std::string& file)
{
  return isCloudFile(file) || fs::path(file).filename() == "metadata.yaml";
}

std::string whyNotRunFolder(const std::string& folder)
{
  const fs::path converted = fs::path(folder) / run_files::recording;
  return folder + ": is the output folder of a run; give its recording, " +
         (fs::exists(converted) ? converted.string() : "which is \"input\" in its report.json");
}

/** The recording in a folder that was probably meant, for the message; empty if there is none. */
std::string recordingWithin(const fs::path& folder)
{
  for (const fs::path& root :
       {folder, folder / "sequences", folder / "dataset" / "sequences", folder / "data_3d_raw"})
  {
    for (const auto& entry : entriesIfReadable(root))
    {
      const std::string name = entry.path().string();
      if (lowerExtension(name) == ".rawlog" ||
          (recordingKind(name) != RecordingKind::unknown && !isRunFolder(name)))
      {
        return name;
      }
    }
  }
  return "";
}

std::string whyNoRecording(const std::string& folder)
{
  const std::string within = recordingWithin(folder);
  return folder + ": is no rawlog, bag, capture or folder of scans: " +
         (within.empty() ? "it has no .bin, .pcd, .ply, .bag, .db3 or .mcap files and no folder "
                           "velodyne or velodyne_points"
                         : "give one of the recordings in it, such as " + within);
}
}  // namespace

RecordingConverter::RecordingConverter(const std::string& input)
    : input_(input),
      kitti_(recordingKind(input) == RecordingKind::kitti ? kittiKindOf(input) : std::nullopt),
      needed_(recordingKind(input) != RecordingKind::unknown || isPartOfRecording(input))
{
  if (isRunFolder(input))
  {
    throw UserError(whyNotRunFolder(input));
  }
  if (!needed_ && fs::is_directory(input))
  {
    throw UserError(whyNoRecording(input));
  }
}

std::string RecordingConverter::program() const
{
  return kitti_ ? "kitti2rawlog --kind " + toString(*kitti_) : "scans2rawlog";
}

ConversionResult RecordingConverter::convert(const std::string& output,
                                             const RecordingOptions& options,
                                             const ConversionProgress& progress,
                                             const BagUnpackingProgress& unpacking,
                                             const ScanRange& range) const
{
  if (kitti_)
  {
    options.requireFitting(RecordingKind::kitti);
    KittiConverterOptions of_kitti;
    static_cast<ScanRange&>(of_kitti) = range;
    of_kitti.kind = *kitti_;
    of_kitti.sensor_pose = options.sensor_pose;
    of_kitti.dt = options.dt;
    of_kitti.deskewed = options.deskewed;
    of_kitti.vertical_angle_correction = options.vertical_angle_correction;
    return convertKitti(input_, output, of_kitti, progress);
  }
  ScanConverterOptions of_scans;
  static_cast<RecordingOptions&>(of_scans) = options;
  static_cast<ScanRange&>(of_scans) = range;
  return convertScans(input_, output, of_scans, progress, unpacking);
}
}  // namespace dyslam
