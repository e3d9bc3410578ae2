// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/ScanTensors.h>

#include <vector>

namespace dyslam
{
// Neighbourhoods of points: found, described and fed to layers. On a CPU each is one pass of our
// own over the points, the same for any number of threads; elsewhere the plain torch version in
// namespace `plain`, which the tests hold against it.

/** Usable points of scan 2 near each point, nearest first; unusable places come last. */
struct Neighbours
{
  torch::Tensor index;   //!< [N, K] node of the level
  torch::Tensor usable;  //!< [N, K] 1 or 0
};

/** The `count` nearest occupied nodes of a level among the window around each point. */
[[nodiscard]] Neighbours nearestInWindow(const torch::Tensor& points,
                                         const torch::Tensor& valid,
                                         const ScanTensors& scan,
                                         std::size_t level,
                                         std::int64_t half_rows,
                                         std::int64_t half_cols,
                                         std::int64_t count);

/** [N, K, 3] from each centre to the nodes of its group, in units of the nodes' spacing there. */
[[nodiscard]] torch::Tensor groupOffsets(const torch::Tensor& xyz,
                                         const torch::Tensor& centre,
                                         const torch::Tensor& index,
                                         double spacing);

/** What a cost volume knows of each candidate. Not differentiable. */
struct Candidates
{
  static constexpr std::int64_t geometry_size = 10;
  torch::Tensor geometry;  //!< [N, K, 10] for the layers
  torch::Tensor planes;    //!< [N, K, 7]: normal, normal . q, q
};
[[nodiscard]] Candidates candidateGeometry(const torch::Tensor& warped,
                                           const torch::Tensor& warped_normal,
                                           const ScanTensors::Level& grid,
                                           const torch::Tensor& index,
                                           double spacing);

/** Surface of scan 2's full-resolution image around each point. Not differentiable. */
struct Surfaces
{
  static constexpr std::int64_t feature_size = 10;
  torch::Tensor normal;     //!< [N, 3]
  torch::Tensor target;     //!< [N, 3] weighted mean of the near points
  torch::Tensor offset;     //!< [N] normal . target
  torch::Tensor features;   //!< [N, 10] for the mask: residual, thickness, shape, distance...
  torch::Tensor thickness;  //!< [N] deviation of the near points from their plane [m]
  torch::Tensor valid;      //!< [N]
};
/** \param warped_normal undefined: features are left undefined too. */
[[nodiscard]] Surfaces surfacesAround(const torch::Tensor& warped,
                                      const torch::Tensor& warped_normal,
                                      const torch::Tensor& valid,
                                      const ScanTensors& scan);

/** leaky([geometry, features[index]] weight^T + bias + own), [N, K, out]: the first layer over
 * groups, without ever writing the groups down. \param geometry [N, K, G]. \param features [M, C]
 * or undefined for C = 0. \param weight [out, G + C]. \param own [N, out] of the whole group, or
 * undefined. */
[[nodiscard]] torch::Tensor groupedLinear(const torch::Tensor& geometry,
                                          const torch::Tensor& features,
                                          const torch::Tensor& index,
                                          const torch::Tensor& weight,
                                          const torch::Tensor& bias,
                                          double slope,
                                          const torch::Tensor& own = {});

/** Largest of each channel over the usable places of a group, [N, C]; 0 where none is. */
[[nodiscard]] torch::Tensor groupMax(const torch::Tensor& x, const torch::Tensor& usable);

/** Sum over each group's places of attention [N, K] times values [N, K, C]; [N, C]. */
[[nodiscard]] torch::Tensor attendedSum(const torch::Tensor& attention,
                                        const torch::Tensor& values);

namespace plain
{
Neighbours nearestInWindow(const torch::Tensor& points,
                           const torch::Tensor& valid,
                           const ScanTensors& scan,
                           std::size_t level,
                           std::int64_t half_rows,
                           std::int64_t half_cols,
                           std::int64_t count);
torch::Tensor groupOffsets(const torch::Tensor& xyz,
                           const torch::Tensor& centre,
                           const torch::Tensor& index,
                           double spacing);
Candidates candidateGeometry(const torch::Tensor& warped,
                             const torch::Tensor& warped_normal,
                             const ScanTensors::Level& grid,
                             const torch::Tensor& index,
                             double spacing);
Surfaces surfacesAround(const torch::Tensor& warped,
                        const torch::Tensor& warped_normal,
                        const torch::Tensor& valid,
                        const ScanTensors& scan);
torch::Tensor groupedLinear(const torch::Tensor& geometry,
                            const torch::Tensor& features,
                            const torch::Tensor& index,
                            const torch::Tensor& weight,
                            const torch::Tensor& bias,
                            double slope,
                            const torch::Tensor& own = {});
torch::Tensor groupMax(const torch::Tensor& x, const torch::Tensor& usable);
torch::Tensor attendedSum(const torch::Tensor& attention, const torch::Tensor& values);
}  // namespace plain
}  // namespace dyslam
