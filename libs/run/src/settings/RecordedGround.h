// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/GroundPlane.h>
#include <dyslam/core/Scan.h>

#include <cstddef>
#include <optional>
#include <vector>

namespace dyslam
{
/** Ground plane in the vehicle frame of a recording, from several of its scans. */
class RecordedGround
{
 public:
  /** Adds a scan. \param returns number of its returns */
  void add(const Scan& scan, std::size_t returns);

  /** Mean plane of the scans that agree, axes of the vehicle frame, origin at the lidar; nothing if
   * these are too few.
   * \param min_returns scans with fewer returns are ignored */
  [[nodiscard]] std::optional<GroundPlane> plane(GroundSide side, std::size_t min_returns) const;

 private:
  struct Searched
  {
    std::size_t returns = 0;
    std::optional<GroundPlane> below;
    std::optional<GroundPlane> above;  //!< only searched for if there is none below
  };

  std::vector<Searched> scans_;
};

/** Whether the vehicle frame should be levelled. */
[[nodiscard]] bool isInclined(const std::optional<GroundPlane>& ground);
}  // namespace dyslam
