// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/CellLayers.h>

#include <cstdint>

namespace dyslam
{
constexpr std::int64_t peak_channels = 3;  //!< channels of peakOffset()

/** Convolutional GRU over occupied cells (3 x 3 sparse convolutions). */
class ConvGruImpl : public torch::nn::Module
{
 public:
  ConvGruImpl(std::int64_t hidden, std::int64_t input);
  /** \param state N x hidden \param input N x input \param neighbours N x 9 row indices
   * \return the new state. */
  torch::Tensor forward(const torch::Tensor& state,
                        const torch::Tensor& input,
                        const torch::Tensor& neighbours);

 private:
  std::int64_t hidden_;
  CellConv gates_{nullptr};
  CellConv candidate_{nullptr};
};
TORCH_MODULE(ConvGru);

/** One iteration of RAFT's recurrent update: computes a flow increment from the correlation at the
 * current flow and the hidden state. The convolutions propagate information between neighbouring
 * cells. */
class FlowUpdateImpl : public torch::nn::Module
{
 public:
  FlowUpdateImpl(std::int64_t hidden, std::int64_t motion, int radius);

  struct Result
  {
    torch::Tensor state;   //!< N x hidden
    torch::Tensor change;  //!< N x 2, increment of the flow [cells]
  };
  /** \param correlation N x (2r+1)^2 around the current flow \param flow N x 2 [cells], relative to
   * the static flow \param neighbours N x 9 row indices, -1 for none (int32). */
  Result forward(const torch::Tensor& state,
                 const torch::Tensor& correlation,
                 const torch::Tensor& flow,
                 const torch::Tensor& neighbours);

 private:
  int radius_;
  RowLinear motion_{nullptr};
  RowLinear motion_deep_{nullptr};
  ConvGru gru_{nullptr};
  RowLinear head_{nullptr};
  RowLinear head_out_{nullptr};
};
TORCH_MODULE(FlowUpdate);

/** Convex upsampling (RAFT): flow at fine cells as learned convex combinations of the 3 x 3 coarse
 * cells, computed for queries only.
 *
 * \param flow N x 2, flow of the coarse cells \param weights N x (9 f^2) logits
 * \param neighbours N x 9 row indices, -1 for none (int32)
 * \param row Q rows of the coarse cells (int64)
 * \param sub Q positions y * f + x of the fine cells in their coarse cells (int64)
 * \param factor f
 * \return Q x 2. Empty neighbours have no weight.
 */
[[nodiscard]] torch::Tensor upsampleFlow(const torch::Tensor& flow,
                                         const torch::Tensor& weights,
                                         const torch::Tensor& neighbours,
                                         const torch::Tensor& row,
                                         const torch::Tensor& sub,
                                         std::int64_t factor);
}  // namespace dyslam
