// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/VoxelGrid.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace dyslam
{
struct MapQualityOptions
{
  double radius = 0.5;              //!< radius of the neighbourhood of a point [m]
  std::size_t min_neighbours = 10;  //!< least number of neighbours of an evaluated point
};

/** Sharpness of a map around one of its points. */
struct PointSharpness
{
  double entropy = 0;         //!< 0.5 ln |2 pi e Sigma| [nats, for coordinates in m]
  double plane_variance = 0;  //!< smallest eigenvalue of Sigma [m^2]
  std::size_t neighbours = 0;
};

/** Sharpness of a map, without ground truth: errors of the trajectory double or thicken walls. The
 * map is added in pieces.
 *
 * Sigma is the covariance (over n) of all points of the map within the radius of a point. Only the
 * chosen points are in memory; the map is streamed.
 *
 * Source: Droeschel, Stueckler, Behnke, Local multi-resolution representation for 6D motion
 * estimation and mapping with a continuously rotating 3D laser scanner, ICRA 2014 (mean map
 * entropy); Razlaw et al., Evaluation of registration methods for sparse 3D laser scans, ECMR 2015
 * (both); the plane variance is the smallest eigenvalue, as in Kornilov, Ferrer, Be your own
 * benchmark, ECMR 2021.
 */
class MapQuality
{
 public:
  /** \param points points of the map [m] that are evaluated; they have to be added by add(), too
   * \throws std::invalid_argument for a radius that is not positive and min_neighbours < 4. */
  MapQuality(std::vector<Eigen::Vector3f> points, const MapQualityOptions& options = {});

  /** Adds points of the map [m], in any order; points that are not finite are ignored. */
  void add(const std::vector<Eigen::Vector3f>& points);

  /** Sharpness at each evaluated point; nothing if it has too few neighbours or all of them lie in
   * one plane to within a micrometre. */
  [[nodiscard]] std::vector<std::optional<PointSharpness>> sharpness() const;

 private:
  /** Sums over the neighbours of a point, relative to it. */
  struct Moments
  {
    std::size_t count = 0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  };

  std::vector<Eigen::Vector3f> points_;
  MapQualityOptions options_;
  float inverse_cell_;
  VoxelHash cells_;                                //!< cells of side `radius` to lists
  std::vector<std::vector<std::uint32_t>> lists_;  //!< chosen points that reach into a cell
  std::vector<Moments> moments_;
};

/** Mean sharpness of a map; smaller is better for both. */
struct MapSharpness
{
  std::size_t points = 0;          //!< number of points in the means
  double mean_entropy = 0;         //!< mean of `entropy` [nats]; NaN without points
  double mean_plane_variance = 0;  //!< mean of plane_variance [m^2]; NaN without points
};

/** Mean sharpness of several maps of the same scans, over the points that have a value in all maps:
 * a bad trajectory scatters points until some have no neighbours, and must not profit from that.
 * \param maps one entry per evaluated point each, in the same order
 * \throws std::invalid_argument for different numbers of points. */
[[nodiscard]] std::vector<MapSharpness> meanSharpness(
    const std::vector<std::vector<std::optional<PointSharpness>>>& maps);
}  // namespace dyslam
