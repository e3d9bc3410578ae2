// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/SceneExport.h>
#include <dyslam/mapbuilder/MapBuilder.h>
#include <dyslam/mapexport/MapExport.h>

namespace dyslam
{
/** Scene of the map, the trajectories and the moving objects. An `area` limits it to the points
 * there and the objects that come there; trajectories and paths of objects are whole.
 * With `full_resolution` it has a point per 0.1 m, the limit for smooth viewing, instead of one per
 * voxel; needs MapBuilder::scans(). */
[[nodiscard]] SceneContent sceneOf(MapBuilder& builder, const MapExportOptions& exports);
}  // namespace dyslam
