// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <string>
#include <vector>

namespace dyslam
{
/** SUSTechPOINTS boxes of one scan (`label_json/NNNNNN.json`): lidar frame, yaw in [-pi, pi].
 * The id is -1 where `obj_id` is missing, empty or no number. \throws UserError. */
[[nodiscard]] std::vector<LabelledBox> readSustechJson(const std::string& path, int frame);
}  // namespace dyslam
