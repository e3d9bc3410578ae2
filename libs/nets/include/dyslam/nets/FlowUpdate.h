// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/CellLayers.h>

#include <cstdint>

namespace dyslam
{
/** A gated recurrent unit over occupied cells: 3 x 3 convolutions in place of matrices. */
class ConvGruImpl : public torch::nn::Module
{
 public:
  ConvGruImpl(std::int64_t hidden, std::int64_t input);
  /** \param state N x hidden \param input N x input \param around N x 9 rows of the cells around
   * \return the new state. */
  torch::Tensor forward(const torch::Tensor& state,
                        const torch::Tensor& input,
                        const torch::Tensor& around);

 private:
  std::int64_t hidden_;
  CellConv gates_{nullptr};
  CellConv candidate_{nullptr};
};
TORCH_MODULE(ConvGru);

/** One step of RAFT's scheme: what the correlation says at the present flow, into a recurrent
 * state, out of which comes a change of the flow. Neighbouring cells inform one another through
 * the state. */
class FlowUpdateImpl : public torch::nn::Module
{
 public:
  FlowUpdateImpl(std::int64_t hidden, std::int64_t motion, int radius);

  struct Result
  {
    torch::Tensor state;   //!< N x hidden
    torch::Tensor change;  //!< N x 2, of the flow [cells]
  };
  /** \param correlation N x (2r+1)^2 around the present flow \param flow N x 2 [cells], relative to
   * the static flow \param around N x 9 rows of the cells around, -1 for none (int32). */
  Result forward(const torch::Tensor& state,
                 const torch::Tensor& correlation,
                 const torch::Tensor& flow,
                 const torch::Tensor& around);

 private:
  int radius_;
  RowLinear motion_{nullptr};
  RowLinear motion_deep_{nullptr};
  ConvGru gru_{nullptr};
  RowLinear head_{nullptr};
  RowLinear head_out_{nullptr};
};
TORCH_MODULE(FlowUpdate);

/** Flow at fine cells as learned convex combinations of the 3 x 3 coarse cells around (RAFT's
 * upsampling), computed only where asked.
 *
 * \param flow N x 2 of the coarse cells \param weights N x (9 f^2) logits
 * \param around N x 9 rows of the cells around, -1 for none (int32)
 * \param row of the coarse cell of each of the Q queries (int64)
 * \param sub of each query: position (y * f + x) of the fine cell in its coarse cell (int64)
 * \return Q x 2. Empty neighbours have no weight.
 */
[[nodiscard]] torch::Tensor upsampleFlow(const torch::Tensor& flow,
                                         const torch::Tensor& weights,
                                         const torch::Tensor& around,
                                         const torch::Tensor& row,
                                         const torch::Tensor& sub,
                                         std::int64_t factor);
}  // namespace dyslam
