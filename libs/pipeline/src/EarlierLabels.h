// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <string>

namespace dyslam
{
/** Labels of an earlier run on the same scans: odometry, and segmenters that do not need the pose,
 * do not use the points labelled as moving.
 *
 * A run that confuses traffic with the static world still labels most of the vehicles as moving, by
 * their appearance and by the rays of other scans; without them the next run finds the static
 * world. */
class EarlierLabels
{
 public:
  /** \param folder folder of the .label files or of the run; empty: no labels \throws UserError if
   * it has no labels. */
  explicit EarlierLabels(const std::string& folder);

  [[nodiscard]] bool any() const { return !folder_.empty(); }
  /** Removes the points labelled as moving from the scan: they become no returns.
   * \return a scan of only these points, empty without labels \throws UserError if the scan has no
   * label file, or one for another number of points. */
  [[nodiscard]] Scan takeMoving(Frame& frame) const;

 private:
  std::string folder_;
};

/** Restores the removed points in scan and cloud; if the frame has moving probabilities, they are
 * marked as moving.
 * \param moving result of takeMoving() \param cloud their cloud, deskewed as the frame's */
void putBackMoving(const Scan& moving, const Cloud& cloud, Frame& frame);
}  // namespace dyslam
