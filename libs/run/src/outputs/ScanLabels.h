// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/formats/LabelFiles.h>

#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
/** SemanticKITTI label of every point of the frame's scan: moving or static; points of reported
 * objects have their class and instanceOfTrack(). Points that are not in the cloud are unlabelled,
 * except near ones that continue a moving object (labelNearReturns()). */
[[nodiscard]] std::vector<Label> scanLabels(const Frame& frame);

/** Label of a reported object's points. */
[[nodiscard]] Label labelOf(const TrackedObject& object);

/** Instance number of an object in labels, by its id. */
[[nodiscard]] std::uint16_t instanceOfTrack(int id);

/** Indices in the scan of the points of an object's detection. */
[[nodiscard]] std::vector<std::uint32_t> sourcesOf(const Frame& frame, const TrackedObject& object);
}  // namespace dyslam
