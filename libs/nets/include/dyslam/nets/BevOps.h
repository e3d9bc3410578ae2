// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

#include <cstdint>

namespace dyslam
{
/** Channel-wise maximum over the points of each cell (PointPillars' max pooling), 0 for empty
 * cells.
 *
 * \param features P x C, not negative \param cell P cell indices (int32) \param cells number of
 * cells \return cells x C. The gradient goes to the first point that attains the maximum. CPU and
 * CUDA.
 */
[[nodiscard]] torch::Tensor pillarMax(const torch::Tensor& features,
                                      const torch::Tensor& cell,
                                      std::int64_t cells);

/** A sparse feature map: only the occupied cells have rows. */
struct SparseMap
{
  torch::Tensor rows;   //!< M x C
  torch::Tensor index;  //!< H x W (int32): row of each cell, -1 for empty ones
  torch::Tensor empty;  //!< C: feature of all empty cells
};

/** Correlation of single cells with windows of another feature map (RAFT's cost volume lookup,
 * computed on demand instead of for all pairs).
 *
 * \param source N x C features
 * \param target feature map of the other scan
 * \param centre N x 2 (x, y) window centres in cells of the target; may be fractional
 * \param radius radius of the windows, r [cells]
 * \return N x (2r+1)^2, row by row (y slow, x fast): <source, target at centre + (x, y)> / sqrt(C),
 * with bilinear interpolation and zeros outside the target. Gradients reach source and target (rows
 * and empty), not centre. Any device; hand-written on the CPU.
 */
[[nodiscard]] torch::Tensor correlate(const torch::Tensor& source,
                                      const SparseMap& target,
                                      const torch::Tensor& centre,
                                      int radius);

/** correlate() from torch operations: used on CUDA and as reference in tests. */
[[nodiscard]] torch::Tensor correlateReference(const torch::Tensor& source,
                                               const SparseMap& target,
                                               const torch::Tensor& centre,
                                               int radius);

/** Expected offset (x, y) [cells] under softmax(correlation), within 1.5 cells of its maximum (a
 * local soft-argmax).
 *
 * \param correlation N x (2r+1)^2 \return N x 3: x, y and the probability mass of that
 * neighbourhood. No gradients.
 */
[[nodiscard]] torch::Tensor peakOffset(const torch::Tensor& correlation, int radius);
/** peakOffset() from torch operations: used on CUDA and as reference in tests. */
[[nodiscard]] torch::Tensor peakOffsetReference(const torch::Tensor& correlation, int radius);
}  // namespace dyslam
