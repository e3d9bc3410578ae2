// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace dyslam
{
/** The ground in the vehicle frame of a recording, from several of its scans. */
class RecordedGround
{
 public:
  void add(const Scan& scan);

  /** The mean of the scans that agree, axes of the vehicle frame, origin at the lidar; nothing if
   * they are too few. */
  [[nodiscard]] std::optional<GroundPlane> plane() const;

 private:
  std::vector<GroundPlane> planes_;
  std::size_t scans_ = 0;  //!< that were searched
};

/** Whether the vehicle frame should be levelled. */
[[nodiscard]] bool isInclined(const std::optional<GroundPlane>& ground);
}  // namespace dyslam
