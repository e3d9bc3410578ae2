// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Angle.h>
#include <dyslam/base/Options.h>

namespace dyslam
{
enum class RefineMethod
{
  none,            //!< no registration to a local map: the scan matcher's motion is used
  point_to_plane,  //!< distance to the plane of the map's nearest surface element
  gicp             //!< distribution to distribution
};

/** Ini section `[refine]`. */
struct RefineOptions : Options
{
  RefineMethod method = RefineMethod::point_to_plane;
  double cell_size = 0.4;  //!< least cell size; surfaces are computed from 3 x 3 x 3 cells [m]
  /** Levels of the map, each with cells twice as large. A surface is taken from the smallest cells
   * that have one, so that rings far apart have surfaces, too. 0: by the ring spacing of the first
   * scan. */
  int levels = 0;
  /** On rough objects the points of a single ring form a ribbon along the rays, which moves with
   * the sensor. With several levels, surfaces at an angle to the ray of fewer ring spacings than
   * this are left out. */
  double min_incidence = 4;
  double max_points_per_cell = 200;  //!< upper limit of the points per cell
  double map_spacing = 0.1;  //!< least distance of successive points of a ring in the map [m]
  double map_radius = 100;   //!< distance beyond which cells are dropped [m]
  double sample_size = 0.8;  //!< side of the cubes with one registered point each [m]
  double sparse_sample_size = 0.4;  //!< sample_size for maps of several levels [m]
  int max_points = 10000;           //!< upper limit of the registered points per scan
  int max_iterations = 25;          //!< upper limit per level of the map
  double loss_width = 0.06;         //!< final width of the robust loss [m]
  double max_loss_width = 0.6;      //!< largest initial width, after bad initial guesses [m]
  double initial_sigma = 2;  //!< sigma of the initial guess at the first registration to a map [m]
  double guess_sigma = 0.3;  //!< sigma of a guess that is not the prior: translation [m]
  double guess_sigma_rotation = 2 * radians_per_degree;  //!< sigma of such a guess: rotation [rad]
  /** Residuals of neighbouring points are correlated: this many count as one measurement. Tunnels
   * and open fields, where the prior must outweigh the sampling pattern, need this many; on KITTI
   * drive 0005 the normalised squared error is 0.9 with it, where 6 is exact. */
  double points_per_measurement = 22;
  /** Ground surfaces constrain height, roll and pitch; along the road and in heading they add only
   * errors. Where most points are on the road, they would outweigh walls and posts: the total
   * weight of ground surfaces is limited to this many times that of all others, but not below a
   * fifth of their own, since an open field has no others. */
  double max_ground_weight_ratio = 12;
  /** Share of the points that have a surface in the map: below, the map's cells are too small for
   * the sensor's rings, whose surfaces then move with the sensor. */
  double min_surface_share = 0.14;
  /** Inliers, by their robust weight, among the points that have a surface in the map; below, the
   * registration has failed. The share of points that have one depends on the sensor. */
  double min_inlier_ratio = 0.3;

  void describe(OptionsVisitor& visitor) override;
};
}  // namespace dyslam
