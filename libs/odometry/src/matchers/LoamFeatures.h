// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/core/Frame.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Ini section `[loam]`. */
struct LoamOptions : Options
{
  double edge_curvature = 0.02;    //!< least curvature of an edge point [1]
  double plane_curvature = 0.005;  //!< largest curvature of a plane point [1]
  int edges = 4;              //!< edge points (sharpest) per sixth of a ring that are registered
  int target_edges = 20;      //!< edge points (sharpest) per sixth of a ring in the reference scan
  int planes = 8;             //!< plane points (flattest) per sixth of a ring that are registered
  double plane_size = 0.3;    //!< reference scan: one plane point per cube of this side [m]
  double max_distance = 2;    //!< largest distance of correspondences, at the first iterations [m]
  double end_distance = 0.7;  //!< largest distance of correspondences, at the last iterations [m]
  double loss_width = 0.1;    //!< width of the robust loss [m]
  int max_iterations = 30;
  double map_distance = 1;             //!< largest distance of correspondences to the map [m]
  double map_edge_size = 0.3;          //!< spacing of the map's edge points [m]
  double map_plane_size = 0.5;         //!< spacing of the map's plane points [m]
  double map_radius = 80;              //!< distance beyond which map points are dropped [m]
  double points_per_measurement = 20;  //!< number of points that count as one measurement

  void describe(OptionsVisitor& visitor) override;
};

/** Ini section `[loam_no_mapping]`: the options without those of the map. */
struct LoamNoMappingOptions : LoamOptions
{
  void describe(OptionsVisitor& visitor) override;
};

/** A point on an edge or a plane. */
struct LoamPoint
{
  Eigen::Vector3f p;  //!< vehicle frame [m]
  std::uint16_t ring;
  float weight;
};

struct LoamFeatures
{
  std::vector<LoamPoint> edges;          //!< sharpest edge points, which are registered
  std::vector<LoamPoint> target_edges;   //!< edge points as reference, also less sharp ones
  std::vector<LoamPoint> planes;         //!< flattest plane points, which are registered
  std::vector<LoamPoint> target_planes;  //!< all plane points, thinned, as reference
};

/** Edge and plane points of a frame by the curvature along its rings (Zhang and Singh, LOAM, 2014).
 * Empty if the rings cannot be identified. */
[[nodiscard]] LoamFeatures loamFeatures(const Frame& frame, const LoamOptions& options);
}  // namespace dyslam
