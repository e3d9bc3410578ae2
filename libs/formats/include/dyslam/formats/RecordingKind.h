// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace dyslam
{
/** Ending of a bag's name in lower case, without that of a compression; `.bag` also of one that its
 * recorder has not closed, `drive.bag.active`. */
[[nodiscard]] std::string bagEnding(const std::string& path);
/** The command that unpacks a file that is compressed as a whole, by the ending of its name: "zstd
 * -d" for `.zstd` and `.zst`; also for `.gz`, `.bz2` and `.xz`. Empty for all others. */
[[nodiscard]] std::string unpackCommand(const std::string& path);
/** Whether a name is one of a bag: `.bag`, `.db3` or `.mcap`, maybe compressed (`.zstd`). */
[[nodiscard]] bool isBagFile(const std::string& path);
/** Whether a name is one of a bag that is compressed as a whole: `drive.db3.zstd`. */
[[nodiscard]] bool isPackedBag(const std::string& path);
/** Whether a path is a bag, or a folder that has bags and no point clouds. */
[[nodiscard]] bool isBag(const std::string& path);

/** Whether an input is a lidar on the network, "udp:2368" (UdpAddress), instead of a path. */
[[nodiscard]] bool isNetworkInput(const std::string& input);
/** Whether an input is a topic of ROS 2, "ros2:/points", or the scans in its domain, "ros2:",
 * instead of a path. */
[[nodiscard]] bool isRos2Input(const std::string& input);
/** Whether an input is live: a lidar on the network or a topic of ROS 2. */
[[nodiscard]] bool isLiveInput(const std::string& input);

/** Kind of a recording, as far as the converters differ. */
enum class RecordingKind
{
  unknown,  //!< a file that may be a rawlog, or a folder without a recording
  bag,
  capture,  //!< network capture
  network,  //!< no recording: a lidar on the network, see isNetworkInput()
  topics,   //!< no recording: live topics of ROS 2, see isRos2Input()
  kitti,    //!< a folder in one of KITTI's layouts, see kittiKindOf()
  scans     //!< a folder of point clouds
};

/** KITTI's folder layouts. */
enum class KittiKind
{
  odometry,  //!< velodyne/NNNNNN.bin, times.txt, calib.txt, poses of camera 0
  raw,       //!< velodyne_points/data/NNNNNN.bin and timestamps, oxts/data, the day's calib files
  tracking,  //!< velodyne/NNNN/NNNNNN.bin, oxts/NNNN.txt, calib/NNNN.txt, label_02/NNNN.txt
  kitti360   //!< 2013_05_28_drive_NNNN_sync with the same folder as raw; poses and calibration
             //!< beside
};
/** Name of a kind as an argument of kitti2rawlog's --kind, such as "odometry". */
[[nodiscard]] std::string toString(KittiKind kind);
/** Kind whose official layout a folder has; nothing for any other folder. */
[[nodiscard]] std::optional<KittiKind> officialKittiKind(const std::string& folder);
/** Kind whose official layout a folder has; for any other folder with a subfolder `velodyne` the
 * most likely kind by its other files; nothing for all other folders, also for those whose
 * `velodyne` has .pcd or .ply scans and no .bin. */
[[nodiscard]] std::optional<KittiKind> kittiKindOf(const std::string& folder);

/** Kind of a recording, by its name and the content of a folder. */
[[nodiscard]] RecordingKind recordingKind(const std::string& path);

/** Advice for a recording that is no rawlog: "is a ROS bag; make a rawlog of it first: scans2rawlog
 * -i drive.bag -o drive.rawlog"; of an Ouster's .osf, which no converter reads, how to save its
 * packets. Empty for all other paths. By name and content of a folder. */
[[nodiscard]] std::string conversionAdvice(const std::string& path);
}  // namespace dyslam
