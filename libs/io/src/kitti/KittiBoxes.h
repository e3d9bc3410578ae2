// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "KittiLayout.h"

namespace dyslam
{
/** Boxes of a folder of SUSTechPOINTS' json files that are named as the scans. \throws UserError.
 */
[[nodiscard]] std::vector<LabelledBox> readBoxFolder(
    const std::string& folder, const std::vector<KittiLayout::Entry>& entries);

/** Boxes without a usable id become objects of their own, each of one scan. \param path of the
 * boxes, for the warning \param warnings gets one if there are such boxes */
void assignMissingIds(const std::string& path,
                      std::vector<LabelledBox>& boxes,
                      std::vector<std::string>& warnings);
}  // namespace dyslam
