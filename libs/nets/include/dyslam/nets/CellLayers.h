// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/nn.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
constexpr double relu = 0;  //!< slope of a leaky ReLU that is a ReLU

/** Concatenated rows: for each of N x K indices the row of `rows`, or zeros for -1.
 *
 * \param rows M x C \param table N x K row indices (int32) \return N x (K C). Gradients reach
 * `rows`. */
[[nodiscard]] torch::Tensor gatherRows(const torch::Tensor& rows, const torch::Tensor& table);

/** leaky(gatherRows(rows, table) weight^T + bias): a sparse convolution over occupied cells.
 *
 * \param rows M x C \param table N x K row indices (int32), -1 for none \param weight out x (K C)
 * \param slope slope of the leaky ReLU; 1 for none \return N x out. Block by block on the CPU, with
 * the same result for any number of threads; torch operations elsewhere. */
[[nodiscard]] torch::Tensor gatheredLinear(const torch::Tensor& rows,
                                           const torch::Tensor& table,
                                           const torch::Tensor& weight,
                                           const torch::Tensor& bias,
                                           double slope);

/** N x width tensor (int32) from a row-major table. */
[[nodiscard]] torch::Tensor tableTensor(const std::vector<std::int32_t>& table, std::int64_t width);

/** Linear layer over rows; parameters as in torch::nn::Linear. */
class RowLinearImpl : public torch::nn::Module
{
 public:
  RowLinearImpl(std::int64_t in, std::int64_t out);
  /** \param rows N x in \param slope slope of the leaky ReLU that follows; 1 for none, 0 for ReLU
   * \return N x out. */
  torch::Tensor forward(const torch::Tensor& rows, double slope = 1);

  torch::Tensor weight;  //!< out x in
  torch::Tensor bias;    //!< out
};
TORCH_MODULE(RowLinear);

/** Submanifold sparse 3 x 3 convolution (Graham and van der Maaten 2017): reads and writes occupied
 * cells only; empty cells are zero and stay empty. */
class CellConvImpl : public torch::nn::Module
{
 public:
  CellConvImpl(std::int64_t in, std::int64_t out);
  /** \param rows M x in \param table N x 9 row indices under the kernel, -1 for none
   * \param slope as RowLinearImpl::forward() \return N x out. */
  torch::Tensor forward(const torch::Tensor& rows, const torch::Tensor& table, double slope = 1);

  torch::Tensor weight;  //!< out x in x 3 x 3
  torch::Tensor bias;    //!< out
};
TORCH_MODULE(CellConv);
}  // namespace dyslam
