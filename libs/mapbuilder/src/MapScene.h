// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/SceneExport.h>
#include <dyslam/mapbuilder/MapBuilder.h>

namespace dyslam
{
/** Scene of the map, the trajectories and the moving objects.
 * \param full_resolution a point per 0.1 m, the limit for smooth viewing, instead of one per voxel;
 *   needs MapBuilder::scans() */
[[nodiscard]] SceneContent sceneOf(MapBuilder& builder, bool full_resolution);
}  // namespace dyslam
