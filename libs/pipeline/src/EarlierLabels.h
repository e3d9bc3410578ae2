// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <string>
#include <vector>

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
  /** Of labels that seem to be the numbers of a learning map, none of which is a moving class. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** \return for each point of the scan whether it is labelled moving; empty if there are no
   * labels. \throws UserError if the scan has no label file, or one of another number of points. */
  [[nodiscard]] std::vector<bool> movingPoints(const Frame& frame) const;

 private:
  std::string folder_;
  bool are_of_learning_map_ = false;
};

/** Takes points out of a cloud that was prepared from the whole scan: times of points that have
 * none are known from the order of all points only. \param moving result of
 * EarlierLabels::movingPoints(); empty: nothing is taken out \return cloud of the points taken out,
 * in the same order */
[[nodiscard]] Cloud takeMoving(const std::vector<bool>& moving, Cloud& cloud);
/** Takes points out of a scan: they are no returns any more.
 * \return scan of the points taken out, as long as the whole; empty if nothing is taken out */
[[nodiscard]] Scan takeMoving(const std::vector<bool>& moving, Scan& scan);

/** Puts the points that were taken out back into scan and cloud of the frame; where it has moving
 * probabilities, they are moving. \param scan, cloud results of takeMoving() */
void putBackMoving(const Scan& scan, const Cloud& cloud, Frame& frame);
}  // namespace dyslam
