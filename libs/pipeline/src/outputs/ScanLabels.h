// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/LabelFiles.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** SemanticKITTI's label of every point of the frame's scan: moving or static; points of reported
 * objects have their class and id + 1 as instance. Points that the cloud left out are unlabelled,
 * but for near ones that continue a moving object (labelNearReturns()). */
[[nodiscard]] std::vector<Label> scanLabels(const Frame& frame);

/** Label of a reported object's points. */
[[nodiscard]] Label labelOf(const TrackedObject& object);

/** The number of a track's object in labels: its instance. */
[[nodiscard]] std::uint16_t instanceOfTrack(int id);

/** The points of the scan that an object was detected in. */
[[nodiscard]] std::vector<std::uint32_t> sourcesOf(const Frame& frame, const TrackedObject& object);
}  // namespace dyslam
