// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/eval/Association.h>
#include <dyslam/eval/TrajectoryMetrics.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** One curve of a plot. */
struct TrajectoryPlotItem
{
  std::string name;
  PosePairs pairs;
};

struct TrajectoryPlotOptions
{
  std::string title;
  Alignment alignment = Alignment::se3;
  /** What the reference is if its own errors can be as large as those of the estimates, as
   * "GNSS/INS": the plots are then titled as differences to it, not as errors; else empty. */
  std::string difference_to;
};

/** PNG of the aligned trajectories from above and of their errors over the distance travelled:
 * position after alignment and, unless the reference has positions alone, translation of each step.
 * The view from above is x-y, or x-z if the
 * reference moves along its own z axis, as KITTI's cameras do.
 * \throws std::invalid_argument without items or for an item without poses. */
[[nodiscard]] std::vector<std::uint8_t> renderTrajectoryPlot(
    const std::vector<TrajectoryPlotItem>& items, const TrajectoryPlotOptions& options = {});

/** A path that is drawn without alignment. */
struct NamedPath
{
  std::string name;
  std::vector<Pose> poses;  //!< poses whose position is not finite are left out
};

/** PNG of trajectories from above without a reference, so neither aligned nor with errors. The view
 * (x-y or x-z) is chosen by the first path, as in renderTrajectoryPlot(). \throws
 * std::invalid_argument without paths or for a path without poses. */
[[nodiscard]] std::vector<std::uint8_t> renderPaths(const std::vector<NamedPath>& paths);
}  // namespace dyslam
