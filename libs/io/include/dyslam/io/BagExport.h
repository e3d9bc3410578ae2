// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/Conversion.h>
#include <dyslam/io/RawlogSource.h>

#include <string>

namespace dyslam
{
/** What is written of a recording, and the results of a run that are written with it. */
struct BagExportOptions
{
  RawlogSourceOptions source;  //!< how the rawlog is read; roll and pitch are not used
  std::string trajectory;      //!< TUM file of T_map_vehicle; empty: none
  /** motions.csv of the run that `trajectory` is of, with its odometry_tum.txt beside it; empty:
   * the covariances of poses and velocities are not known. */
  std::string motions;
  std::string labels;        //!< folder of NNNNNN.label files, see labelFolderOf(); empty: none
  std::string tracks;        //!< tracks.txt of a run; empty: none; needs `trajectory`
  std::string map;           //!< .pcd or .ply in the map frame; empty: none; needs `trajectory`
  bool no_scans = false;     //!< no scans, only poses, objects, map and other sensors
  bool static_only = false;  //!< of the scans only those without moving points; needs `labels`
  bool force = false;        //!< an earlier file of the name is replaced
};

/** Writes a rawlog, and what a run found in it, as a bag of ROS 2 (mcap). Its topics, types and
 * frames are those of "ROS bag, out" in doc/formats.md: transforms, scans, samples of the other
 * sensors, true poses and, of a run, trajectory, objects and map.
 *
 * Messages have the stamp of their scan or sample. Frames are those of the recording, not levelled.
 * Only one scan is in memory at a time, beside map, tracks and trajectory. The same input gives the
 * same bytes.
 *
 * The bag is written under a temporary name. If `progress` throws, it is removed.
 * \throws UserError, also if the file is there already; after damage of the rawlog no bag is
 * written, and the message has the flags of the scans before it. */
ConversionResult exportBag(const std::string& rawlog,
                           const std::string& output,
                           const BagExportOptions& options,
                           const ConversionProgress& progress = {});
}  // namespace dyslam
