// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Frame.h>
#include <dyslam/core/Options.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Ini section `[loam]`. */
struct LoamOptions : Options
{
  double edge_curvature = 0.02;    //!< least curvature of an edge point (1)
  double plane_curvature = 0.005;  //!< ... and largest of a plane point (1)
  int edges = 4;                   //!< sharpest points per sixth of a ring, registered
  int target_edges = 20;           //!< ... the same of the reference scan
  int planes = 8;                  //!< flattest points per sixth of a ring, registered
  double plane_size = 0.3;  //!< plane points of the reference scan: one per cube of this side [m]
  double max_distance = 2;  //!< largest distance of correspondences between scans, at the start [m]
  double end_distance = 0.7;  //!< ... and at the end [m]
  double loss_width = 0.1;    //!< of the robust loss [m]
  int max_iterations = 30;
  double map_distance = 1;             //!< largest distance of correspondences to the map [m]
  double map_edge_size = 0.3;          //!< spacing of the map's edges [m]
  double map_plane_size = 0.5;         //!< ... and plane points [m]
  double map_radius = 80;              //!< farther points are dropped [m]
  double points_per_measurement = 20;  //!< points that count as one measurement

  void describe(OptionsVisitor& visitor) override;
};

/** Ini section `[loam_no_mapping]`: those of the scans alone. */
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
  std::vector<LoamPoint> edges;          //!< the sharpest
  std::vector<LoamPoint> target_edges;   //!< less sharp ones too
  std::vector<LoamPoint> planes;         //!< the flattest
  std::vector<LoamPoint> target_planes;  //!< all flat ones, thinned
};

/** Edge and plane points of a frame by the curvature along its rings (Zhang and Singh, LOAM, 2014).
 * Empty if the rings cannot be identified. */
[[nodiscard]] LoamFeatures loamFeatures(const Frame& frame, const LoamOptions& options);
}  // namespace dyslam
