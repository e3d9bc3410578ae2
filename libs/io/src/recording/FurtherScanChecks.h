// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <map>
#include <string>

namespace dyslam
{
class RecordingNotes;

/** Notes what the user should know about scans that are merged with those of the first lidar. */
class FurtherScanChecks
{
 public:
  /** \param part scan of a further lidar \param lidar ScanPart::lidar of it \param scan that it
   * joins */
  void check(const Scan& part, std::size_t lidar, const Scan& scan, RecordingNotes& notes);

 private:
  struct Mounting
  {
    std::string label;
    Pose T_vehicle_lidar = Pose::Identity();
  };

  /** Notes that a further lidar has the mounting of another one. */
  void checkMounting(const Scan& part, std::size_t lidar, const Scan& scan, RecordingNotes& notes);

  std::map<std::size_t, Mounting> mountings_;  //!< by ScanPart::lidar
};
}  // namespace dyslam
