// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/RunMerger.h>
#include <dyslam/mapbuilder/MapBuilder.h>
#include <dyslam/mapbuilder/RunFolder.h>

#include <string>
#include <vector>

namespace dyslam
{
/** The map from above, with the paths of the vehicle and of moving objects, and their last boxes.
 * \throws UserError if the file cannot be written, as all of these. */
void writeMapPicture(const MapBuilder& builder, const std::string& path);

/** Writes the uncleaned map, with removed points in red, beside the cleaned map.
 * \pre uncleanedMap() */
void writeCleaningPicture(const MapBuilder& builder, const std::string& path);

/** Writes the maps of the single runs, each in its own frame, beside the merged map. */
void writeMergePicture(const std::vector<RunFolder>& runs,
                       const RunMerge& merge,
                       const MapBuilder& builder,
                       const std::string& path);
}  // namespace dyslam
