// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/ScanTensors.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
// Neighbourhoods of points: search, geometry features and grouped layers. On the CPU each is one
// hand-written pass over the points, with the same result for any number of threads; elsewhere the
// implementation from torch operations in namespace `reference`, which the tests compare with.

/** Nearest nodes of scan 2 for each point, nearest first; unused slots come last. */
struct Neighbours
{
  torch::Tensor index;   //!< [N, K] node index
  torch::Tensor usable;  //!< [N, K] 1 or 0
};

/** The `count` nearest occupied nodes within the image window around each projected point. */
[[nodiscard]] Neighbours nearestInWindow(const torch::Tensor& points,
                                         const torch::Tensor& valid,
                                         const ScanTensors& scan,
                                         std::size_t level,
                                         std::int64_t half_rows,
                                         std::int64_t half_cols,
                                         std::int64_t count);

/** [N, K, 3] offsets from each centre to the nodes of its group, in units of the node spacing at
 * the centre's range. */
[[nodiscard]] torch::Tensor groupOffsets(const torch::Tensor& xyz,
                                         const torch::Tensor& centre,
                                         const torch::Tensor& index,
                                         double spacing);

/** Geometry of each candidate of a cost volume. Not differentiable. */
struct Candidates
{
  static constexpr std::int64_t geometry_size = 10;
  torch::Tensor geometry;  //!< [N, K, 10] input of the layers
  torch::Tensor planes;    //!< [N, K, 7]: normal, normal . q, q
};
[[nodiscard]] Candidates candidateGeometry(const torch::Tensor& warped,
                                           const torch::Tensor& warped_normal,
                                           const ScanTensors::Level& grid,
                                           const torch::Tensor& index,
                                           double spacing);

/** Local surface of scan 2's full-resolution image at each point. Not differentiable. */
struct Surfaces
{
  static constexpr std::int64_t feature_size = 10;
  torch::Tensor normal;    //!< [N, 3] surface normals
  torch::Tensor target;    //!< [N, 3] weighted mean of the neighbouring points [m]
  torch::Tensor offset;    //!< [N] normal . target
  torch::Tensor features;  //!< [N, 10] input of the mask: residual, thickness, shape, distance, ...
  torch::Tensor
      thickness;        //!< [N] standard deviation of the neighbouring points from their plane [m]
  torch::Tensor valid;  //!< [N] 1 for points with a surface
};
/** \param warped_normal may be undefined; then there are no features. */
[[nodiscard]] Surfaces surfacesAround(const torch::Tensor& warped,
                                      const torch::Tensor& warped_normal,
                                      const torch::Tensor& valid,
                                      const ScanTensors& scan);

/** First layer over groups: leaky([geometry, features[index]] weight^T + bias + own), [N, K, out],
 * without forming the concatenation. \param geometry [N, K, G] \param features [M, C] or undefined
 * for C = 0 \param index [N, K] \param weight [out, G + C] \param own [N, out] term added per
 * group, or undefined. */
[[nodiscard]] torch::Tensor groupedLinear(const torch::Tensor& geometry,
                                          const torch::Tensor& features,
                                          const torch::Tensor& index,
                                          const torch::Tensor& weight,
                                          const torch::Tensor& bias,
                                          double slope,
                                          const torch::Tensor& own = {});

/** Channel-wise maximum over the usable members of each group, [N, C]; 0 for empty groups. */
[[nodiscard]] torch::Tensor groupMax(const torch::Tensor& x, const torch::Tensor& usable);

/** Attention-weighted sum over each group: attention [N, K], values [N, K, C]; [N, C]. */
[[nodiscard]] torch::Tensor attendedSum(const torch::Tensor& attention,
                                        const torch::Tensor& values);

namespace reference
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
}  // namespace reference
}  // namespace dyslam
