// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/nets/PreparedScan.h>
#include <torch/torch.h>

#include <array>
#include <cstdint>

namespace dyslam
{
/** A PreparedScan as tensors on the network's device. N nodes per level, row-major. */
struct ScanTensors
{
  struct Level
  {
    std::int64_t rows = 0;
    std::int64_t cols = 0;
    torch::Tensor xyz;        //!< [N, 3] m
    torch::Tensor valid;      //!< [N] 1 for occupied nodes, else 0
    torch::Tensor normal;     //!< [N, 3], levels 1 and above
    torch::Tensor planarity;  //!< [N], levels 1 and above
  };

  std::int64_t rows = 0;       //!< image rows
  torch::Tensor image_xyz;     //!< [rows * columns, 3]
  torch::Tensor image_valid;   //!< [rows * columns]
  torch::Tensor row_of_slope;  //!< [slope_bins], integer
  std::array<Level, PreparedScan::level_count> levels;
};

[[nodiscard]] ScanTensors toTensors(const PreparedScan& scan, torch::Device device = torch::kCPU);
/** Updates the coordinates in tensors that were made from `scan` after its points have moved. */
void updatePoints(const PreparedScan& scan, ScanTensors& tensors);

/** A rigid motion as tensors: p -> rotation p + translation. */
struct PoseTensors
{
  torch::Tensor rotation;     //!< [3, 3]
  torch::Tensor translation;  //!< [3]

  [[nodiscard]] static PoseTensors identity(const torch::TensorOptions& options);
  [[nodiscard]] static PoseTensors from(const Pose& pose, const torch::TensorOptions& options);
  [[nodiscard]] Pose toPose() const;
  [[nodiscard]] torch::Tensor apply(const torch::Tensor& points) const;  //!< [N, 3]
  /** Composition: applies `other` first. */
  [[nodiscard]] PoseTensors operator*(const PoseTensors& other) const;
  [[nodiscard]] PoseTensors detached() const;
};

/** Image windows around the projections of points, as node indices. */
struct Window
{
  torch::Tensor index;   //!< [N, K] node or cell index, clamped to the grid
  torch::Tensor inside;  //!< [N, K] 1 within the grid, 0 beyond its rows
};

/** Windows of (2 half_rows + 1) x (2 half_cols + 1) nodes of a level (`rows` x `cols`) around the
 * projections of points [N, 3]. `dilation` [N] (integer) spreads the columns; may be undefined.
 */
[[nodiscard]] Window windowAround(const torch::Tensor& points,
                                  const ScanTensors& scan,
                                  std::int64_t rows,
                                  std::int64_t cols,
                                  std::int64_t half_rows,
                                  std::int64_t half_cols,
                                  const torch::Tensor& dilation = {});

/** Windows between two grids: for each node of `to` the `window_rows` x `window_cols`
 * nodes of `from` nearest to its direction. */
[[nodiscard]] Window windowBetween(std::int64_t from_rows,
                                   std::int64_t from_cols,
                                   std::int64_t to_rows,
                                   std::int64_t to_cols,
                                   std::int64_t window_rows,
                                   std::int64_t window_cols,
                                   torch::Device device);

/** Rows of `values` [M, C] selected by `index` [N, K]: [N, K, C]. */
[[nodiscard]] torch::Tensor gather(const torch::Tensor& values, const torch::Tensor& index);
}  // namespace dyslam
