// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/formats/RosMessages.h>

#include <cstddef>
#include <string>
#include <vector>

#include "conversion/ScanSink.h"

namespace dyslam
{
/** Mountings of the sensors of a bag. */
struct BagFrames
{
  std::string lidar;         //!< frame of the scans
  RosTransforms transforms;  //!< transforms of /tf_static
  /** Topics with packets of the IMU in the lidar, indices in Bag::topics(), if the scans are
   * packets, too: it is mounted and timed as these say. */
  std::vector<std::size_t> imu_packets;
  std::vector<std::string> conflicts;  //!< of /tf_static, as of staticTransforms()
};

/** Another lidar of the vehicle. */
struct FurtherTopic
{
  std::size_t topic = 0;
  std::string label;
  std::string calibration;  //!< file; empty: none
  Pose T_vehicle_lidar;
};

/** Mounts the lidar as the bag's transforms have it, if the options ask for that; else a note says
 * that it could. \throws UserError if the transforms do not have its pose. */
void mountLidar(const std::string& input,
                Bag& bag,
                const BagFrames& frames,
                const ScanConverterOptions& options,
                ScanSink& sink);

/** The topics of --further-topic. \param scans topic of the first lidar \throws UserError if one
 * is missing, or if the transforms do not place its lidar. */
[[nodiscard]] std::vector<FurtherTopic> furtherTopics(const std::string& input,
                                                      Bag& bag,
                                                      std::size_t scans,
                                                      const BagFrames& frames,
                                                      const ScanConverterOptions& options,
                                                      ScanSink& sink);
}  // namespace dyslam
