// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Labels.h>
#include <dyslam/core/Scan.h>
#include <dyslam/eval/MapMetrics.h>
#include <dyslam/eval/Table.h>

#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** The map that other maps are compared with. */
struct ReferenceMap
{
  std::string path;
  Scan cloud;
};

/** \throws UserError for a file that cannot be read. */
[[nodiscard]] ReferenceMap readReferenceMap(const std::string& path);

/** Labels of a reference map, or why it has none. */
struct ReferenceLabels
{
  std::vector<Label> labels;
  std::string missing;         //!< reason; empty: there are labels
  std::string from_intensity;  //!< meaning of the intensities that are labels; empty: of a file
};

/** Labels of a reference map: those of the file `labels`, else of F.label beside the map, else of
 * the map's intensity, if all are flags (0, 1) or SemanticKITTI classes and not all are the same.
 * \throws UserError for a file that cannot be read or has another number of labels. */
[[nodiscard]] ReferenceLabels readReferenceLabels(const ReferenceMap& reference,
                                                  const std::string& labels = "");

/** A map to evaluate: its name and its file (pcd, ply). */
using NamedMap = std::pair<std::string, std::string>;

struct MapComparisonReport
{
  Table table;
  std::string json;
};

/** Shares of static points preserved and of dynamic points rejected. \throws UserError for a file
 * that cannot be read. */
[[nodiscard]] MapComparisonReport compareByLabels(const ReferenceMap& reference,
                                                  const std::vector<Label>& labels,
                                                  const std::vector<NamedMap>& maps,
                                                  const MapMetricsOptions& metrics);

/** For maps without labels: distances of the points of each map from the other map. \param
 * distances PLY file to write, the map coloured by distance; empty: none \throws UserError for a
 * file that cannot be read or written, or a map without points. */
[[nodiscard]] MapComparisonReport compareByDistance(const ReferenceMap& reference,
                                                    const std::vector<NamedMap>& maps,
                                                    const std::string& distances = "");
}  // namespace dyslam
