// SPDX-License-Identifier: BSD-3-Clause
#include "KittiCalibFinder.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/Kitti360Files.h>
#include <dyslam/io/OptionError.h>

namespace dyslam
{
namespace fs = std::filesystem;

std::string firstExisting(const std::string& named, const std::vector<fs::path>& candidates)
{
  if (!named.empty())
  {
    if (!fs::exists(named))
    {
      throw UserError(named + ": no such file or folder");
    }
    return named;
  }
  for (const fs::path& candidate : candidates)
  {
    if (fs::exists(candidate))
    {
      return candidate.string();
    }
  }
  return {};
}

fs::path folderAbove(const fs::path& folder)
{
  const fs::path above = (folder / "..").lexically_normal();
  return above.has_filename() ? above : above.parent_path();
}

KittiCalibFinder::KittiCalibFinder(const fs::path& input,
                                   const std::string& sequence,
                                   const KittiConverterOptions& options)
    : input_(input), sequence_(sequence), options_(options)
{
}

/** Folders that raw's three calibration files may lie in: the day's, or the drive's. */
std::vector<fs::path> KittiCalibFinder::rawFolders() const
{
  const std::string day = nameOfFile(input_).substr(0, 10);  // of 2011_09_26_drive_0001
  const fs::path above = folderAbove(input_);
  return {input_, above, (above / day).lexically_normal(),
          (folderAbove(above) / day).lexically_normal()};
}

/** Folders that KITTI-360's calibration may be: that of the data set, in which the drive is in
 * `data_3d_raw`, first. */
std::vector<fs::path> KittiCalibFinder::foldersOf360() const
{
  const fs::path above = folderAbove(input_);
  return {(folderAbove(above) / "calibration").lexically_normal(),
          (above / "calibration").lexically_normal(), input_ / "calibration", input_};
}

void KittiCalibFinder::read()
{
  std::vector<fs::path> candidates{input_ / "calib.txt"};
  if (!sequence_.empty())
  {
    candidates.insert(candidates.begin(), input_ / "calib" / (sequence_ + ".txt"));
  }
  if (options_.kind == KittiKind::raw)
  {
    for (const fs::path& folder : rawFolders())
    {
      if (fs::exists(folder / "calib_velo_to_cam.txt") ||
          fs::exists(folder / "calib_imu_to_velo.txt"))
      {
        candidates.push_back(folder);
      }
    }
  }
  if (options_.kind == KittiKind::kitti360)
  {
    for (const fs::path& folder : foldersOf360())
    {
      if (isKitti360Calib(folder.string()))
      {
        candidates.push_back(folder);
      }
    }
  }
  path_ = firstExisting(options_.calib, candidates);
  const bool is_folder = !path_.empty() && fs::is_directory(path_);
  if (options_.kind == KittiKind::kitti360 && is_folder && !isKitti360Calib(path_))
  {
    throw UserError(path_ + ": has no calib_cam_to_velo.txt; give KITTI-360's folder calibration");
  }
  if (!path_.empty())
  {
    calib_ = readKittiCalib(path_);
  }
}

std::string KittiCalibFinder::missingText(const std::string& for_what) const
{
  if (options_.kind == KittiKind::raw)
  {
    return input_.string() + ": neither " + folderAbove(input_).string() +
           " nor the drive's folder has calib_cam_to_cam.txt, calib_velo_to_cam.txt and "
           "calib_imu_to_velo.txt, needed for " +
           for_what + "; put them there, or name their folder with --calib of kitti2rawlog";
  }
  if (options_.kind == KittiKind::kitti360)
  {
    return input_.string() + ": " + foldersOf360().front().string() +
           " has no calib_cam_to_velo.txt and calib_cam_to_pose.txt, needed for " + for_what +
           "; put them there, or name their folder with --calib of kitti2rawlog";
  }
  return input_.string() + ": has no calib.txt, which is needed for " + for_what +
         "; name it with --calib of kitti2rawlog";
}

const KittiCalib& KittiCalibFinder::require(const std::string& for_what)
{
  if (path_.empty())
  {
    read();
  }
  if (path_.empty())
  {
    throw OptionError(missingText(for_what), "--calib");
  }
  return calib_;
}

const Pose& KittiCalibFinder::requireCamera(const std::string& for_what)
{
  if (!require(for_what).has_camera)
  {
    throw UserError(path_ +
                    (options_.kind == KittiKind::kitti360 ? ": has no perspective.txt, needed for "
                                                          : ": has no calib_cam_to_cam.txt and "
                                                            "calib_velo_to_cam.txt, needed for ") +
                    for_what);
  }
  return calib_.T_cam_velo;
}

const Pose& KittiCalibFinder::requireImu(const std::string& for_what)
{
  if (!require(for_what).has_imu)
  {
    throw UserError(path_ + ": has no IMU mounting (" +
                    (options_.kind == KittiKind::kitti360 ? "calib_cam_to_pose.txt"
                     : fs::is_directory(path_)            ? "calib_imu_to_velo.txt"
                                                          : "Tr_imu_velo") +
                    "), needed for " + for_what);
  }
  return calib_.T_velo_imu;
}
}  // namespace dyslam
