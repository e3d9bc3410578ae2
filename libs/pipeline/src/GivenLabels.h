// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** The points of one scan with a given moving label: taken out of scan and cloud before the motion
 * is estimated, and put back after it. Does nothing where there are no labels. */
class LabelledPoints
{
 public:
  /** \param moving for each point of the scan whether it is labelled moving; empty: no labels */
  explicit LabelledPoints(std::vector<bool> moving) : moving_(std::move(moving)) {}

  /** Takes the points out of a cloud that was prepared from the whole scan: times of points that
   * have none are known from the order of all points only. Where the cloud is prepared again, the
   * points of the last one are put back. */
  void takeFrom(Cloud& cloud);
  /** Takes the points out of the scan: they are no returns any more. */
  void takeFrom(Scan& scan);
  /** Puts the points back into scan and cloud of the frame; where it has moving probabilities, they
   * are moving. */
  void putBack(Frame& frame) const;

 private:
  std::vector<bool> moving_;
  Cloud cloud_;  //!< points taken out of the cloud, in the same order
  Scan scan_;    //!< points taken out of the scan; as long as the whole, empty if nothing was taken
};

/** Labels that are given for the scans (`dyseg.labels`), of an earlier run or another program:
 * odometry, and segmenters that do not need the pose, do not use the points labelled as moving.
 *
 * A run that confuses traffic with the static world still labels most of the vehicles as moving, by
 * their appearance and by the rays of other scans; without them the next run finds the static
 * world. */
class GivenLabels
{
 public:
  /** \param folder folder of the .label files or of the run; empty: no labels \throws UserError if
   * it has no labels. */
  explicit GivenLabels(const std::string& folder);

  [[nodiscard]] bool any() const { return !folder_.empty(); }
  /** Of labels that seem to be the numbers of a learning map, none of which is a moving class. */
  [[nodiscard]] std::vector<std::string> warnings() const;
  /** The points of the frame's scan that are labelled as moving. \throws UserError if the scan has
   * no label file, or one of another number of points. */
  [[nodiscard]] LabelledPoints pointsOf(const Frame& frame) const;

 private:
  std::string folder_;
  bool are_of_learning_map_ = false;
};
}  // namespace dyslam
