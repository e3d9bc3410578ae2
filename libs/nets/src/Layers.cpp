// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/Grouping.h>
#include <dyslam/nets/Layers.h>
#include <dyslam/nets/PointLinear.h>

#include <cmath>
#include <string>

namespace dyslam
{
namespace
{
constexpr double leak = 0.1;
constexpr double masked_logit = 1e4;

/** [N, K] 1 where a window's node is occupied. */
torch::Tensor usableOf(const torch::Tensor& valid, const Window& window)
{
  return valid.index_select(0, window.index.reshape({-1})).reshape(window.index.sizes()) *
         window.inside;
}

/** Softmax over the valid entries of dimension 1; 0 if there are none. */
torch::Tensor maskedSoftmax(const torch::Tensor& logits, const torch::Tensor& valid)
{
  return torch::softmax(logits + (valid - 1) * masked_logit, 1) * valid;
}
}  // namespace

MlpImpl::MlpImpl(const std::vector<std::int64_t>& sizes, bool linear_end) : linear_end_(linear_end)
{
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i)
  {
    const double sigma = std::sqrt(2.0 / static_cast<double>(std::max<std::int64_t>(sizes[i], 1)));
    weights_.push_back(register_parameter("weight" + std::to_string(i),
                                          torch::randn({sizes[i + 1], sizes[i]}) * sigma));
    biases_.push_back(register_parameter("bias" + std::to_string(i), torch::zeros({sizes[i + 1]})));
  }
}

double MlpImpl::slope(std::size_t layer) const
{
  return linear_end_ && layer + 1 == weights_.size() ? 1.0 : leak;
}

torch::Tensor MlpImpl::from(std::size_t layer, torch::Tensor x) const
{
  for (; layer < weights_.size(); ++layer)
  {
    x = pointLinear(x, weights_[layer], biases_[layer], slope(layer));
  }
  return x;
}

torch::Tensor MlpImpl::forward(const torch::Tensor& x)
{
  return from(0, x);
}

torch::Tensor MlpImpl::forward(const torch::Tensor& places, const torch::Tensor& own)
{
  const torch::Tensor& weight = weights_.front();
  const std::int64_t split = places.size(2);
  const torch::Tensor of_group =
      pointLinear(own, weight.slice(1, split), torch::zeros_like(biases_.front()), 1);
  return from(1, groupedLinear(places, {}, {}, weight.slice(1, 0, split), biases_.front(), slope(0),
                               of_group));
}

void MlpImpl::scaleOutput(double factor)
{
  const torch::NoGradGuard no_grad;
  weights_.back().mul_(factor);
}

GroupedMlpImpl::GroupedMlpImpl(std::int64_t geometry, std::int64_t features, const Sizes& sizes)
{
  const auto in = static_cast<double>(geometry + features);
  weight_ = register_parameter(
      "weight", torch::randn({sizes.front(), geometry + features}) * std::sqrt(2.0 / in));
  bias_ = register_parameter("bias", torch::zeros({sizes.front()}));
  if (sizes.size() > 1)
  {
    rest_ = register_module("rest", Mlp(sizes));
  }
}

torch::Tensor GroupedMlpImpl::forward(const torch::Tensor& geometry,
                                      const torch::Tensor& features,
                                      const torch::Tensor& index,
                                      const torch::Tensor& own)
{
  const torch::Tensor x = groupedLinear(geometry, features, index, weight_, bias_, leak, own);
  return rest_.is_empty() ? x : rest_->forward(x);
}

SetConvImpl::SetConvImpl(std::int64_t in, const Sizes& mlp, double spacing) : spacing_(spacing)
{
  mlp_ = register_module("mlp", GroupedMlp(3, in, mlp));
}

torch::Tensor SetConvImpl::forward(const torch::Tensor& features,
                                   const ScanTensors::Level& from,
                                   const ScanTensors::Level& to,
                                   const Window& window)
{
  const torch::Tensor offsets = groupOffsets(from.xyz, to.xyz, window.index, spacing_);
  return groupMax(mlp_->forward(offsets, features, window.index), usableOf(from.valid, window));
}

AttentiveCostVolumeImpl::AttentiveCostVolumeImpl(std::int64_t features,
                                                 std::int64_t hidden,
                                                 std::int64_t out,
                                                 std::int64_t half_rows,
                                                 std::int64_t half_cols,
                                                 std::int64_t candidates,
                                                 double spacing)
    : half_rows_(half_rows), half_cols_(half_cols), candidates_(candidates), spacing_(spacing)
{
  own_ = register_module("own", Mlp(Sizes{features, hidden}, true));
  embed_ = register_module("embed", GroupedMlp(Candidates::geometry_size, features, Sizes{hidden}));
  embed_rest_ = register_module("embed_rest", Mlp(Sizes{hidden, out, out}));
  attend_ =
      register_module("attend", Mlp(Sizes{out + Candidates::geometry_size, out / 2, 1}, true));
  patch_embed_ = register_module("patch_embed", GroupedMlp(3, out, Sizes{hidden, out}));
  patch_attend_ = register_module("patch_attend", Mlp(Sizes{2 * out, out / 2, 1}, true));
}

Correlation AttentiveCostVolumeImpl::forward(const torch::Tensor& warped,
                                             const torch::Tensor& warped_normal,
                                             const torch::Tensor& valid,
                                             const torch::Tensor& features1,
                                             const ScanTensors& scan2,
                                             std::size_t level,
                                             const torch::Tensor& features2,
                                             const Window& patch)
{
  const ScanTensors::Level& grid = scan2.levels[level];
  const Neighbours near =
      nearestInWindow(warped, valid, scan2, level, half_rows_, half_cols_, candidates_);
  const Candidates candidates =
      candidateGeometry(warped, warped_normal, grid, near.index, spacing_);
  const torch::Tensor hidden =
      embed_->forward(candidates.geometry, features2, near.index, own_->forward(features1));
  const torch::Tensor embedded = embed_rest_->forward(hidden);
  const torch::Tensor attention = maskedSoftmax(
      attend_->forward(torch::cat({embedded, candidates.geometry}, 2)).squeeze(2), near.usable);

  Correlation result;
  result.valid = near.usable.amax(1);
  const torch::Tensor plane = attendedSum(attention, candidates.planes);
  result.normal = plane.slice(1, 0, 3);
  result.offset = plane.select(1, 3);
  result.target = plane.slice(1, 4, 7);
  const torch::Tensor first = attendedSum(attention, embedded);

  const torch::Tensor offsets = groupOffsets(warped, warped, patch.index, spacing_);
  const torch::Tensor patched = patch_embed_->forward(offsets, first, patch.index);
  const torch::Tensor patch_attention = maskedSoftmax(
      patch_attend_->forward(patched, first).squeeze(2), usableOf(result.valid, patch));
  result.embedding = first + attendedSum(patch_attention, patched);
  return result;
}

SetUpConvImpl::SetUpConvImpl(std::int64_t coarse,
                             std::int64_t fine,
                             std::int64_t out,
                             double spacing)
    : spacing_(spacing)
{
  gather_ = register_module("gather", GroupedMlp(3, coarse, Sizes{out}));
  fusion_ = register_module("join", Mlp(Sizes{out + fine, out}));
}

torch::Tensor SetUpConvImpl::forward(const torch::Tensor& coarse_features,
                                     const ScanTensors::Level& coarse,
                                     const torch::Tensor& fine_features,
                                     const ScanTensors::Level& fine,
                                     const Window& window)
{
  const torch::Tensor offsets = groupOffsets(coarse.xyz, fine.xyz, window.index, spacing_);
  const torch::Tensor x = gather_->forward(offsets, coarse_features, window.index);
  const torch::Tensor gathered = groupMax(x, usableOf(coarse.valid, window));
  return fusion_->forward(torch::cat({gathered, fine_features}, 1));
}

DynamicMaskImpl::DynamicMaskImpl(DyloMask kind, std::int64_t embedding, std::int64_t features)
    : kind_(kind)
{
  const std::int64_t in = kind == DyloMask::attention ? embedding + features : embedding;
  if (kind == DyloMask::attention)
  {
    spatial_ = register_module("spatial", Mlp(Sizes{embedding + features, features, 1}, true));
    channel_ = register_module(
        "channel", Mlp(Sizes{features, std::max<std::int64_t>(features / 2, 4), features}, true));
  }
  if (kind != DyloMask::none)
  {
    mask_ = register_module("mask", Mlp(Sizes{in, embedding, embedding / 2, 2}, true));
    mask_->scaleOutput(0.1);
  }
}

MaskLogits DynamicMaskImpl::forward(const torch::Tensor& embedding,
                                    const torch::Tensor& features,
                                    const torch::Tensor& valid)
{
  if (kind_ == DyloMask::none)
  {
    const torch::Tensor certain = torch::full({embedding.size(0)}, 20.0, embedding.options());
    return {certain, certain};
  }
  torch::Tensor x = embedding;
  if (kind_ == DyloMask::attention)
  {
    // Spatial attention from E and F gives F'; channel attention gives F''' (Fig. 4, Eq. 1).
    const torch::Tensor spatial_attention =
        torch::sigmoid(spatial_->forward(torch::cat({embedding, features}, 1)));
    const torch::Tensor attended = features * spatial_attention;
    const torch::Tensor mask_column = valid.unsqueeze(1);
    const torch::Tensor mean =
        (attended * mask_column).sum(0, true) / mask_column.sum().clamp_min(1);
    const torch::Tensor largest =
        (attended + (mask_column - 1) * masked_logit).amax(0, true).clamp_min(-10);
    const torch::Tensor channels =
        torch::sigmoid(channel_->forward(mean) + channel_->forward(largest));
    x = torch::cat({embedding, attended * channels}, 1);
  }
  const torch::Tensor logits = mask_->forward(x) + torch::tensor({2.0F, 0.F}, x.options());
  return {logits.select(1, 0), logits.select(1, 1)};
}

torch::Tensor maskWeights(const MaskLogits& logits, const torch::Tensor& valid)
{
  const torch::Tensor x = torch::log_sigmoid(logits.is_static) + torch::log_sigmoid(logits.quality);
  return torch::softmax(x + (valid - 1) * masked_logit, 0) * valid;
}
}  // namespace dyslam
