// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/odometry/RefineOptions.h>

#include "SurfacePyramid.h"

namespace dyslam
{
void RefineOptions::describe(OptionsVisitor& v)
{
  v.choice("method", method,
           {{"none", RefineMethod::none},
            {"point_to_plane", RefineMethod::point_to_plane},
            {"gicp", RefineMethod::gicp}},
           "method of the registration to the local map");
  v.real("cell_size", cell_size, 0.05, 10, "least side of the local map's smallest cells [m]");
  v.integer(
      "levels", levels, 0, SurfacePyramid::max_levels,
      "levels of the local map, each with cells twice as large; 0: by the spacing of the rings");
  v.real("min_incidence", min_incidence, 0, 20,
         "least angle between ray and surface, for maps of several levels [ring spacings]");
  v.real("max_points_per_cell", max_points_per_cell, 6, 1e6,
         "upper limit of the points per cell of the local map");
  v.real("map_spacing", map_spacing, 0, 10,
         "least distance of successive points of a ring that are added to the local map [m]");
  v.real("map_radius", map_radius, 5, 1000,
         "distance from the vehicle beyond which cells of the local map are dropped [m]");
  v.real("sample_size", sample_size, 0.05, 20,
         "side of the cubes with one registered point each, for maps of one level [m]");
  v.real("sparse_sample_size", sparse_sample_size, 0.05, 20,
         "side of the cubes with one registered point each, for maps of several levels [m]");
  v.integer("max_points", max_points, 100, 1000000,
            "upper limit of the registered points per scan");
  v.integer("max_iterations", max_iterations, 1, 200,
            "upper limit of the registration's iterations per level");
  v.real("loss_width", loss_width, 0.001, 10,
         "final width of the robust loss of the residuals [m]");
  v.real("max_loss_width", max_loss_width, 0.001, 10,
         "largest initial width of the robust loss, after bad initial guesses [m]");
  v.real("initial_sigma", initial_sigma, 0, 50,
         "sigma of the initial guess at the first registration to a map [m]");
  v.real("guess_sigma", guess_sigma, 1e-4, 1e3,
         "sigma of the translation of an initial guess that is not the prior [m]");
  v.degrees("guess_sigma_rotation_deg", guess_sigma_rotation, 1e-3, 180,
            "sigma of the rotation of an initial guess that is not the prior [deg]");
  v.renamed("guess_sigma_angle_deg", "guess_sigma_rotation_deg");
  v.real("points_per_measurement", points_per_measurement, 1, 1e6,
         "number of correlated points that count as one measurement");
  v.real("max_ground_weight_ratio", max_ground_weight_ratio, 1e-3, 1e9,
         "upper limit of the weight of ground surfaces, relative to all other surfaces");
  v.real("min_surface_share", min_surface_share, 0, 1,
         "share of points with a surface in the map below which registration has failed (cells too "
         "small)");
  v.real("min_inlier_ratio", min_inlier_ratio, 0, 1,
         "share of inliers among the points with a surface in the map below which registration has "
         "failed");
}
}  // namespace dyslam
