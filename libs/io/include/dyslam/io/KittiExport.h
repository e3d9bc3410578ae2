// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/Conversion.h>
#include <dyslam/io/ScanRange.h>

#include <string>

namespace dyslam
{
struct KittiExportOptions : Options, ScanRange
{
  std::string sequence = "00";  //!< name of the folder of the sequence
  std::string trajectory;       //!< TUM or KITTI poses of the vehicle; empty: the recording's truth
  std::string calib;            //!< KITTI's calibration; empty: camera axes at the lidar
  std::string tracks;           //!< boxes as readTracks() reads them; empty: none
  std::string sensor_label;     //!< as RawlogSourceOptions::sensor_label
  std::string further_lidars;   //!< as in RawlogSourceOptions; not with `rings`
  bool no_scans = false;        //!< only times, calibration and poses
  bool deskew = false;          //!< move the points to where they were at the stamp of their scan
  bool poses_only = false;      //!< only poses/NN.txt
  bool force = false;           //!< replace what an earlier export of the sequence wrote
  bool rings = false;           //!< write NNNNNN.ring beside the scans, one byte per point

  void describe(OptionsVisitor& visitor) override;
};

/** Writes a rawlog in the layout of KITTI odometry and SemanticKITTI.
 *
 * `<folder>/sequences/NN/` gets `velodyne/NNNNNN.bin` (every point in its order, lidar frame),
 * `point_times/NNNNNN.time` (of scans whose points have differing times, see readPointTimes()),
 * `times.txt` (seconds since the first scan), `calib.txt`, `labels/NNNNNN.label` of the rawlog's
 * ground truth and `poses.txt`; `<folder>/poses/NN.txt` is the same. Poses are those of camera 0 in
 * its first frame, as KITTI's; without a calibration, the camera is at the lidar (x right, y down,
 * z ahead). Poses are left out, with a warning, unless every scan has one. The boxes of `tracks`
 * are written to `<folder>/tracks/NN.txt` as writeKittiTracks() does.
 *
 * With `deskew`, every scan needs a pose; points move along the poses to where the lidar saw them
 * at the stamp, with constant velocity between two scans, and no point times are written.
 *
 * The sequence is written under a temporary name. If `progress` throws, all is removed.
 * \throws UserError, also if there is such a sequence already (with `force`: that has other files,
 * or the calibration), and with `poses_only` unless every scan has a pose. */
ConversionResult exportKitti(const std::string& rawlog,
                             const std::string& folder,
                             const KittiExportOptions& options,
                             const ConversionProgress& progress = {});
}  // namespace dyslam
