// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/types.h>

#include <cstdint>

namespace dyslam
{
/** Channel-wise maximum of the points of each cell, 0 where a cell is empty.
 *
 * \param features P x C, not negative \param cell P cells (int32), from 0 \return cells x C.
 * Gradients go to the first point that attains the maximum. CPU and CUDA.
 */
[[nodiscard]] torch::Tensor pillarMax(const torch::Tensor& features,
                                      const torch::Tensor& cell,
                                      std::int64_t cells);

/** A feature map of which only the occupied cells are stored. */
struct CellMap
{
  torch::Tensor rows;   //!< M x C
  torch::Tensor index;  //!< H x W (int32): the row of each cell, -1 where it is empty
  torch::Tensor empty;  //!< C: what every empty cell holds
};

/** Correlation of single cells with windows of another feature map (RAFT's lookup, computed on
 * demand rather than stored for all pairs).
 *
 * \param source N x C features of the cells that look
 * \param target what they look into
 * \param centre N x 2 (x, y): where each looks, in cells of the target, fractions allowed
 * \param radius of the window in cells
 * \return N x (2r+1)^2, row by row (y slow, x fast): <source, target at centre + (x, y)> /
 * sqrt(C), bilinear in the target and 0 outside it. Gradients reach source and target (and its
 * empty cells), not centre. Any device; on the CPU a hand-written loop.
 */
[[nodiscard]] torch::Tensor correlate(const torch::Tensor& source,
                                      const CellMap& target,
                                      const torch::Tensor& centre,
                                      int radius);

/** The same, slowly, from torch's own operations: used on CUDA and to check the loop. */
[[nodiscard]] torch::Tensor correlateSlow(const torch::Tensor& source,
                                          const CellMap& target,
                                          const torch::Tensor& centre,
                                          int radius);

/** Expected offset (x, y) [cells] under softmax(correlation) around its peak.
 *
 * Only the offsets within 1.5 cells of the best one count, so that a second peak elsewhere does not
 * pull. No gradients. \return N x 3: x, y and the probability mass that was within.
 */
[[nodiscard]] torch::Tensor peakOffset(const torch::Tensor& correlation, int radius);
/** The same, slowly, from torch's own operations: used on CUDA and to check the loop. */
[[nodiscard]] torch::Tensor peakOffsetSlow(const torch::Tensor& correlation, int radius);
}  // namespace dyslam
