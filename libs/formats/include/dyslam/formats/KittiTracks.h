// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/KittiFiles.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Inverse of toLidar(): the box in the camera frame whose heading has the given yaw in the lidar's
 * ground plane. \pre the camera stands upright: its y axis is not horizontal. */
[[nodiscard]] CameraBox toCamera(const Box& box, const Pose& T_cam_velo);

/** Detections of one sequence, boxes in the lidar frame. The layout is recognised by the columns of
 * the first line: AB3DMOT's csv (15, see readDetectionsCsv()), tracking labels with a score (18),
 * or those without the column of the id (17). DontCare lines are left out; the id is -1 where there
 * is none. \throws UserError for any other layout. */
[[nodiscard]] std::vector<LabelledBox> readDetections(const std::string& path,
                                                      const Pose& T_cam_velo);

/** Writes tracks as KITTI's result file of a sequence, in the order given: frame, id, type,
 * truncated, occluded, alpha, image box, height, width, length, x, y, z, ry, score (18 columns,
 * camera frame); blanks in a type become underscores. AB3DMOT's and TrackEval's programs read it:
 * an id must not occur twice in a frame, and every sequence needs a file, if an empty one. \param
 * boxes lidar frame \throws UserError if the file cannot be written. */
void writeKittiTracks(const std::string& path,
                      const std::vector<LabelledBox>& boxes,
                      const Pose& T_cam_velo);
}  // namespace dyslam
