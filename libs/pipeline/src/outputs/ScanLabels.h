// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/LabelFiles.h>

#include <string>
#include <vector>

namespace dyslam
{
/** SemanticKITTI's label of every point of the frame's scan: moving or static; points of reported
 * objects have their class and id + 1 as instance. Points that the cloud left out are unlabelled,
 * but for near ones that continue a moving object (labelNearReturns()). */
[[nodiscard]] std::vector<Label> scanLabels(const Frame& frame);

/** `<folder>/NNNNNN<extension>`, numbered by the frame's index. */
[[nodiscard]] std::string numberedPath(const std::string& folder,
                                       const Frame& frame,
                                       const std::string& extension);
}  // namespace dyslam
