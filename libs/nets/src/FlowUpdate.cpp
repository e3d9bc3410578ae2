// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/FlowUpdate.h>
#include <torch/torch.h>

#include <limits>

namespace dyslam
{
using torch::Tensor;

ConvGruImpl::ConvGruImpl(std::int64_t hidden, std::int64_t input) : hidden_(hidden)
{
  gates_ = register_module("gates", CellConv(hidden + input, 2 * hidden));
  candidate_ = register_module("candidate", CellConv(hidden + input, hidden));
}

Tensor ConvGruImpl::forward(const Tensor& state, const Tensor& input, const Tensor& neighbours)
{
  const auto gates = gates_(torch::cat({state, input}, 1), neighbours).sigmoid();
  const auto update = gates.narrow(1, 0, hidden_);
  const auto reset = gates.narrow(1, hidden_, hidden_);
  const auto candidate = candidate_(torch::cat({reset * state, input}, 1), neighbours).tanh();
  return state + update * (candidate - state);
}

FlowUpdateImpl::FlowUpdateImpl(std::int64_t hidden, std::int64_t motion, int radius)
    : radius_(radius)
{
  const std::int64_t window = (2 * radius + 1) * (2 * radius + 1);
  motion_ = register_module("motion", RowLinear(window + 2 + peak_channels, 2 * motion));
  motion_deep_ = register_module("motion_deep", RowLinear(2 * motion, motion));
  gru_ = register_module("gru", ConvGru(hidden, motion));
  head_ = register_module("head", RowLinear(hidden + motion + peak_channels, 32));
  head_out_ = register_module("head_out", RowLinear(32, 2));
  torch::NoGradGuard no_gradient;
  head_out_->weight.mul_(0.1);
  head_out_->bias.zero_();
}

FlowUpdateImpl::Result FlowUpdateImpl::forward(const Tensor& state,
                                               const Tensor& correlation,
                                               const Tensor& flow,
                                               const Tensor& neighbours)
{
  const auto peak = peakOffset(correlation, radius_);
  const auto first = motion_(torch::cat({correlation, flow, peak}, 1), relu);
  const auto motion = motion_deep_(first, relu);
  Result result;
  result.state = gru_(state, motion, neighbours);
  result.change = head_out_(head_(torch::cat({result.state, motion, peak}, 1), relu));
  return result;
}

Tensor upsampleFlow(const Tensor& flow,
                    const Tensor& weights,
                    const Tensor& neighbours,
                    const Tensor& row,
                    const Tensor& sub,
                    std::int64_t factor)
{
  const auto own = weights.view({-1, 9, factor * factor}).index_select(0, row);
  const auto logits = own.gather(2, sub.view({-1, 1, 1}).expand({-1, 9, 1})).squeeze(2);  // Q x 9
  const auto table = neighbours.index_select(0, row);
  const auto share =
      logits.masked_fill(table.lt(0), -std::numeric_limits<float>::infinity()).softmax(1);
  const auto values = gatherRows(flow, table).view({-1, 9, 2});
  return (values * share.unsqueeze(2)).sum(1);
}
}  // namespace dyslam
