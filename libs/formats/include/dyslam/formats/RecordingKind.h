// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace dyslam
{
/** True for a `.bag`, `.db3` or `.mcap` file, compressed as a whole (`.zstd`) or not. By name. */
[[nodiscard]] bool isBagFile(const std::string& path);
/** True for the same compressed as a whole: `drive.db3.zstd`. By name. */
[[nodiscard]] bool isPackedBag(const std::string& path);
/** True for such a file, and for a folder that has such files and no point clouds. */
[[nodiscard]] bool isBag(const std::string& path);

/** What a path holds, as far as the converters tell it apart. */
enum class RecordingKind
{
  unknown,  //!< a file that may be a rawlog, or a folder without a recording
  bag,
  capture,  //!< of a network
  kitti,    //!< a folder in one of KITTI's layouts, see kittiKindOf()
  scans     //!< a folder of point clouds
};

/** KITTI's folder layouts. */
enum class KittiKind
{
  odometry,  //!< velodyne/NNNNNN.bin, times.txt, calib.txt, poses of camera 0
  raw,       //!< velodyne_points/data/NNNNNN.bin and timestamps, oxts/data, the day's calib files
  tracking   //!< velodyne/NNNN/NNNNNN.bin, oxts/NNNN.txt, calib/NNNN.txt, label_02/NNNN.txt
};
/** "odometry", as an argument of kitti2rawlog's --kind. */
[[nodiscard]] std::string toString(KittiKind kind);
/** The kind whose official layout a folder has; nothing for any other folder. */
[[nodiscard]] std::optional<KittiKind> officialKittiKind(const std::string& folder);
/** The same, and of any other folder with `velodyne` the most likely kind by what lies beside it;
 * nothing if it has none. */
[[nodiscard]] std::optional<KittiKind> kittiKindOf(const std::string& folder);

/** By name, and by what a folder holds. */
[[nodiscard]] RecordingKind recordingKind(const std::string& path);

/** What to do with a recording that is no rawlog: "is a ROS bag; make a rawlog of it first:
 * scans2rawlog -i drive.bag -o drive.rawlog". Empty for everything else. By name, and by what a
 * folder holds. */
[[nodiscard]] std::string conversionAdvice(const std::string& path);
}  // namespace dyslam
