// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <torch/nn.h>

#include <cstdint>

namespace dyslam
{
/** A gated recurrent unit over a map: 3 x 3 convolutions in place of matrices. */
class ConvGruImpl : public torch::nn::Module
{
 public:
  ConvGruImpl(std::int64_t hidden, std::int64_t input);
  /** \param state 1 x hidden x H x W \param input 1 x input x H x W \return the new state. */
  torch::Tensor forward(const torch::Tensor& state, const torch::Tensor& input);

 private:
  std::int64_t hidden_;
  torch::nn::Conv2d gates_{nullptr};
  torch::nn::Conv2d candidate_{nullptr};
};
TORCH_MODULE(ConvGru);

/** One step of RAFT's scheme: what the correlation says at the present flow, into a recurrent
 * state, out of which comes a change of the flow. Only occupied cells look; the state is a whole
 * map, so that they inform one another. */
class FlowUpdateImpl : public torch::nn::Module
{
 public:
  FlowUpdateImpl(std::int64_t hidden, std::int64_t motion, int radius);

  struct Result
  {
    torch::Tensor state;   //!< 1 x hidden x H x W
    torch::Tensor change;  //!< N x 2, of the flow [cells]
  };
  /** \param correlation N x (2r+1)^2 around the present flow \param flow N x 2 [cells], relative to
   * the static flow \param cell N, numbers of the occupied cells (int64). */
  Result forward(const torch::Tensor& state,
                 const torch::Tensor& correlation,
                 const torch::Tensor& flow,
                 const torch::Tensor& cell);

 private:
  int radius_;
  torch::nn::Linear motion_{nullptr};
  torch::nn::Linear motion_deep_{nullptr};
  ConvGru gru_{nullptr};
  torch::nn::Linear head_{nullptr};
  torch::nn::Linear head_out_{nullptr};
};
TORCH_MODULE(FlowUpdate);

/** N x C rows of a 1 x C x H x W map. \param cell numbers y * W + x (int64). */
[[nodiscard]] torch::Tensor gatherCells(const torch::Tensor& map, const torch::Tensor& cell);
/** 1 x C x H x W map with N x C rows at some cells and 0 elsewhere. */
[[nodiscard]] torch::Tensor scatterCells(const torch::Tensor& rows,
                                         const torch::Tensor& cell,
                                         std::int64_t height,
                                         std::int64_t width);

/** Flow at fine cells as learned convex combinations of the 3 x 3 coarse cells around (RAFT's
 * upsampling), computed only where asked.
 *
 * \param flow H x W x 2 of the coarse cells \param weights N x (9 f^2) logits of N coarse cells
 * \param row of `weights` for each of the Q queries \param coarse cell number of each query
 * \param sub of each query: position (y * f + x) of the fine cell in its coarse cell
 * \return Q x 2. Neighbours outside the map count as 0 flow with no weight.
 */
[[nodiscard]] torch::Tensor upsampleFlow(const torch::Tensor& flow,
                                         const torch::Tensor& weights,
                                         const torch::Tensor& row,
                                         const torch::Tensor& coarse,
                                         const torch::Tensor& sub,
                                         std::int64_t factor);
}  // namespace dyslam
