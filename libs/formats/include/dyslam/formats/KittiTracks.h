// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/KittiFiles.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Inverse of toLidar(): the box in the camera frame whose heading has the yaw of `box` in the
 * lidar's xy plane. \pre the camera's y axis is not horizontal */
[[nodiscard]] CameraBox toCamera(const Box& box, const Pose& T_cam_velo);

/** Detections of one sequence, boxes in the lidar frame. The layout is recognised by the columns of
 * the first line: AB3DMOT's csv (15, see readDetectionsCsv()), tracking labels with a score (18),
 * or those without the column of the id (17). DontCare lines are left out; the id is -1 where there
 * is none. \throws UserError for any other layout. */
[[nodiscard]] std::vector<LabelledBox> readDetections(const std::string& path,
                                                      const Pose& T_cam_velo);

/** Objects of one scan in the columns of KITTI's object benchmark: type, truncated, occluded,
 * alpha, image box, height, width, length, x, y, z, ry, with or without a score (16 or 15 columns).
 * The frame is 0, the id -1; DontCare lines are left out. \param T_cam_velo of boxes in the camera
 * frame; nothing: x, y, z is the centre in the lidar frame, ry the heading about its z axis \return
 * lidar frame \throws UserError. */
[[nodiscard]] std::vector<LabelledBox> readKittiObjects(const std::string& path,
                                                        const std::optional<Pose>& T_cam_velo);

/** Writes tracks as KITTI's result file of a sequence, in the order given: frame, id, type,
 * truncated, occluded, alpha, image box, height, width, length, x, y, z, ry, score (18 columns,
 * camera frame); blanks in a type become underscores. AB3DMOT's and TrackEval's programs read it:
 * an id must not occur twice in a frame, and every sequence needs a file, if an empty one. \param
 * boxes lidar frame \throws UserError if the file cannot be written. */
void writeKittiTracks(const std::string& path,
                      const std::vector<LabelledBox>& boxes,
                      const Pose& T_cam_velo);
}  // namespace dyslam
