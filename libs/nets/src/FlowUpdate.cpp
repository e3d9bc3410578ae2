// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/BevOps.h>
#include <dyslam/nets/FlowUpdate.h>
#include <torch/torch.h>

#include <limits>

namespace dyslam
{
namespace nn = torch::nn;
using torch::Tensor;

namespace
{
constexpr std::int64_t peak_channels = 3;

nn::Conv2d conv3(std::int64_t in, std::int64_t out)
{
  return nn::Conv2d(nn::Conv2dOptions(in, out, 3).padding(1));
}
}  // namespace

Tensor gatherCells(const Tensor& map, const Tensor& cell)
{
  return map.permute({0, 2, 3, 1}).reshape({-1, map.size(1)}).index_select(0, cell);
}

Tensor scatterCells(const Tensor& rows, const Tensor& cell, std::int64_t height, std::int64_t width)
{
  return torch::zeros({height * width, rows.size(1)}, rows.options())
      .index_copy(0, cell, rows)
      .view({1, height, width, rows.size(1)})
      .permute({0, 3, 1, 2});
}

ConvGruImpl::ConvGruImpl(std::int64_t hidden, std::int64_t input) : hidden_(hidden)
{
  gates_ = register_module("gates", conv3(hidden + input, 2 * hidden));
  candidate_ = register_module("candidate", conv3(hidden + input, hidden));
}

Tensor ConvGruImpl::forward(const Tensor& state, const Tensor& input)
{
  const auto gates = gates_(torch::cat({state, input}, 1)).sigmoid();
  const auto update = gates.narrow(1, 0, hidden_);
  const auto reset = gates.narrow(1, hidden_, hidden_);
  const auto candidate = candidate_(torch::cat({reset * state, input}, 1)).tanh();
  return state + update * (candidate - state);
}

FlowUpdateImpl::FlowUpdateImpl(std::int64_t hidden, std::int64_t motion, int radius)
    : radius_(radius)
{
  const std::int64_t window = (2 * radius + 1) * (2 * radius + 1);
  motion_ = register_module("motion", nn::Linear(window + 2 + peak_channels, 2 * motion));
  motion_deep_ = register_module("motion_deep", nn::Linear(2 * motion, motion));
  gru_ = register_module("gru", ConvGru(hidden, motion));
  head_ = register_module("head", nn::Linear(hidden + motion + peak_channels, 32));
  head_out_ = register_module("head_out", nn::Linear(32, 2));
  torch::NoGradGuard no_gradient;
  head_out_->weight.mul_(0.1);
  head_out_->bias.zero_();
}

FlowUpdateImpl::Result FlowUpdateImpl::forward(const Tensor& state,
                                               const Tensor& correlation,
                                               const Tensor& flow,
                                               const Tensor& cell)
{
  const auto peak = peakOffset(correlation, radius_).detach();
  auto motion = motion_(torch::cat({correlation, flow, peak}, 1)).relu();
  motion = motion_deep_(motion).relu();
  Result result;
  result.state = gru_(state, scatterCells(motion, cell, state.size(2), state.size(3)));
  const auto rows = torch::cat({gatherCells(result.state, cell), motion, peak}, 1);
  result.change = head_out_(head_(rows).relu());
  return result;
}

Tensor upsampleFlow(const Tensor& flow,
                    const Tensor& weights,
                    const Tensor& row,
                    const Tensor& coarse,
                    const Tensor& sub,
                    std::int64_t factor)
{
  const auto height = flow.size(0);
  const auto width = flow.size(1);
  const auto rows = flow.reshape({-1, 2});
  const auto own = weights.view({-1, 9, factor * factor}).index_select(0, row);
  const auto logits = own.gather(2, sub.view({-1, 1, 1}).expand({-1, 9, 1})).squeeze(2);  // Q x 9
  const auto x = coarse.remainder(width);
  const auto y = coarse.div(width, "floor");
  std::vector<Tensor> values;
  std::vector<Tensor> inside;
  for (std::int64_t dy = -1; dy <= 1; ++dy)
  {
    for (std::int64_t dx = -1; dx <= 1; ++dx)
    {
      const auto nx = x + dx;
      const auto ny = y + dy;
      inside.push_back(nx.ge(0) & ny.ge(0) & nx.lt(width) & ny.lt(height));
      const auto at = ny.clamp(0, height - 1) * width + nx.clamp(0, width - 1);
      values.push_back(rows.index_select(0, at));
    }
  }
  const auto usable = torch::stack(inside, 1);
  const auto share =
      logits.masked_fill(usable.logical_not(), -std::numeric_limits<float>::infinity()).softmax(1);
  return (torch::stack(values, 1) * share.unsqueeze(2)).sum(1);
}
}  // namespace dyslam
