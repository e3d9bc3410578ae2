// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>

#include <functional>
#include <string>

namespace dyslam
{
/** Labels that an earlier run wrote of the same scans: odometry, and a segmenter that does not need
 * the pose, do without the points that it labelled moving.
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
  /** Takes the points that are labelled moving out of the scan: they are no returns any more.
   * \return a scan of these points alone, empty if there are no labels. \throws UserError if the
   * scan has no label file, or one of another number of points. */
  [[nodiscard]] Scan takeMoving(Frame& frame) const;

 private:
  std::string folder_;
};

/** Puts the points that were taken out back into scan and cloud; where the frame has moving
 * probabilities, they are moving.
 * \param moving result of takeMoving() \param prepare cloud of a scan, preprocessed and deskewed as
 * the frame's cloud */
void putBackMoving(const Scan& moving,
                   const std::function<Cloud(const Scan&)>& prepare,
                   Frame& frame);
}  // namespace dyslam
