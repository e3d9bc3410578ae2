// SPDX-License-Identifier: BSD-3-Clause
// Folders in KITTI's layouts for the tests of the converter.
#pragma once

#include <string>

#include "ScanFolders.h"
#include "TestFolder.h"

namespace dyslam
{
constexpr const char* tracking_calib =
    "R_rect 1 0 0 0 1 0 0 0 1\nTr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\n"
    "Tr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n";

/** A line of GNSS/INS readings, this far north of the first [m], in six decimals of a degree. */
inline std::string oxtsLine(double metres_north)
{
  const double latitude = 49.0 + metres_north / 111319.49;
  return std::to_string(latitude) + " 8.4 110 0 0 1.5707963267949" +
         std::string(" 0 0 10 1 2 0 0 0 0 0 0 0 0 0 0 0 0 0.05 0 4 10 4 4 0\n");
}

/** A raw drive of two scans, without calibration. \return its folder */
inline std::string writeRawDrive(const TestFolder& folder)
{
  const std::string drive = "2011_09_26/2011_09_26_drive_0001_sync/";
  writeBins(folder, drive + "velodyne_points/data", 2, 10);
  folder.write(drive + "velodyne_points/timestamps.txt",
               "2011-09-26 13:02:25.951199337\n2011-09-26 13:02:26.055098\n");
  folder.write(drive + "oxts/data/0000000000.txt", oxtsLine(0));
  folder.write(drive + "oxts/data/0000000001.txt", oxtsLine(1));
  return drive;
}
}  // namespace dyslam
