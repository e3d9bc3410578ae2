// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/core/Pose.h>

namespace dyslam
{
/** Overlap of two upright boxes in one frame. Boxes with NaN or without extent overlap nothing. */
struct BoxOverlap
{
  double ground_iou = 0;  //!< intersection over union of the footprints
  double iou = 0;         //!< intersection over union of the volumes
  /** Generalised IoU of the volumes, in (-1, 1]: iou minus the part of the common hull (convex hull
   * of the footprints, times the height both span) that neither fills. -1 if either has no
   * extent. */
  double giou = -1;
};

[[nodiscard]] BoxOverlap boxOverlap(const Box& a, const Box& b);

/** Only BoxOverlap::iou; cheap when the boxes are far apart. */
[[nodiscard]] double boxIou(const Box& a, const Box& b);

/** The box moved by a pose whose up axis is near +z: centre exactly, yaw by the turned x axis. */
[[nodiscard]] Box transformed(const Box& box, const Pose& T);
/** Inverse of transformed(): the box that transformed() takes to `moved` by T. It differs from
 * transformed(moved, T.inverse()) if the frames are tilted against each other, because both yaws
 * are about z. \pre the up axes are not at right angles. */
[[nodiscard]] Box transformedBack(const Box& moved, const Pose& T);
}  // namespace dyslam
