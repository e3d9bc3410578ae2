// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace dyslam
{
/** Labels that an earlier run wrote of the same scans: segmentation and odometry do without the
 * points that it labelled moving.
 *
 * A run that follows traffic for its static world still labels most of its vehicles by their
 * appearance and by the rays of other scans; without them the next run finds the static world. */
class EarlierLabels
{
 public:
  /** \param folder of the .label files, or of the run; empty: there are none. \throws UserError if
   * it has no labels. */
  explicit EarlierLabels(const std::string& folder);

  [[nodiscard]] bool any() const { return !folder_.empty(); }
  /** Makes the points that are labelled moving no returns. \return the points of the scan as they
   * were. \throws UserError if the scan has no label file, or one of another number of points. */
  std::vector<Eigen::Vector3f> removeMoving(Frame& frame) const;

 private:
  std::string folder_;
};

/** Puts points back into a frame that was processed without them: they are moving.
 * \param cloud of these points, deskewed as the frame's \param points of the scan with them */
void putBackMoving(const Cloud& cloud, std::vector<Eigen::Vector3f> points, Frame& frame);
}  // namespace dyslam
