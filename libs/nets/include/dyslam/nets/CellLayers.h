// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <torch/nn.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Rows side by side: for each of N x K positions a row of `rows`, or zeros for -1.
 *
 * \param rows M x C \param table N x K (int32) \return N x (K C). Gradients reach `rows`. */
[[nodiscard]] torch::Tensor gatherRows(const torch::Tensor& rows, const torch::Tensor& table);

/** leaky(sum over K of gathered rows times weights + bias): a convolution over occupied cells.
 *
 * \param rows M x C \param table N x K (int32), -1 for none \param weight out x (K C)
 * \param slope of the leaky rectifier; 1 leaves it out. \return N x out.
 * On a CPU gathered and multiplied block by block, the same result for any number of threads;
 * elsewhere torch's own. */
[[nodiscard]] torch::Tensor gatheredLinear(const torch::Tensor& rows,
                                           const torch::Tensor& table,
                                           const torch::Tensor& weight,
                                           const torch::Tensor& bias,
                                           double slope);

/** A tensor of N x width from a flat table. */
[[nodiscard]] torch::Tensor tableTensor(const std::vector<std::int32_t>& table, std::int64_t width);

/** One layer over rows; torch::nn::Linear's parameters by the same names. */
class RowLinearImpl : public torch::nn::Module
{
 public:
  RowLinearImpl(std::int64_t in, std::int64_t out);
  /** \param slope of a leaky rectifier behind it; 1 leaves it out, 0 is the plain rectifier. */
  torch::Tensor forward(const torch::Tensor& rows, double slope = 1);

  torch::Tensor weight;  //!< out x in
  torch::Tensor bias;    //!< out
};
TORCH_MODULE(RowLinear);

/** A 3 x 3 convolution that reads and writes occupied cells only; what is empty counts as zero and
 * stays empty (submanifold sparse convolution, Graham and van der Maaten 2017). */
class CellConvImpl : public torch::nn::Module
{
 public:
  CellConvImpl(std::int64_t in, std::int64_t out);
  /** \param rows M x in \param table N x 9 rows under the kernel, -1 for none
   * \param slope as above \return N x out. */
  torch::Tensor forward(const torch::Tensor& rows, const torch::Tensor& table, double slope = 1);

  torch::Tensor weight;  //!< out x in x 3 x 3
  torch::Tensor bias;    //!< out
};
TORCH_MODULE(CellConv);
}  // namespace dyslam
