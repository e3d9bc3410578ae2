// SPDX-License-Identifier: BSD-3-Clause
// Includes torch: for nets, train and their tests only.
#pragma once

#include <dyslam/nets/DyloNetworkOptions.h>
#include <dyslam/nets/ScanTensors.h>

#include <cstdint>
#include <vector>

namespace dyslam
{
/** Channels of an MLP, input first. */
using Sizes = std::vector<std::int64_t>;

/** Shared (point-wise) MLP with leaky ReLU, slope 0.1, without normalisation. */
class MlpImpl : public torch::nn::Module
{
 public:
  /** \param sizes input, hidden..., output \param linear_end no activation after the last layer */
  explicit MlpImpl(const Sizes& sizes, bool linear_end = false);
  torch::Tensor forward(const torch::Tensor& x);
  /** forward() of the concatenation of each group's members and its own features, without forming
   * it. \param places [N, K, A] features of the members \param own [N, B] features of the groups
   * \return [N, K, sizes.back()]. */
  torch::Tensor forward(const torch::Tensor& places, const torch::Tensor& own);
  /** Scales the last layer's weights, for an initial output near zero. */
  void scaleOutput(double factor);

 private:
  [[nodiscard]] double slope(std::size_t layer) const;
  [[nodiscard]] torch::Tensor from(std::size_t layer, torch::Tensor x) const;

  std::vector<torch::Tensor> weights_;
  std::vector<torch::Tensor> biases_;
  bool linear_end_;
};
TORCH_MODULE(Mlp);

/** MLP over groups of points; the first layer reads geometry and grouped features. */
class GroupedMlpImpl : public torch::nn::Module
{
 public:
  /** \param sizes output channels of the layers */
  GroupedMlpImpl(std::int64_t geometry, std::int64_t features, const Sizes& sizes);
  /** \param geometry [N, K, G] \param features [M, C] or undefined \param index [N, K] into them.
   * \param own [N, sizes.front()] term added to the first layer of each group, or undefined
   * \return [N, K, sizes.back()]. */
  torch::Tensor forward(const torch::Tensor& geometry,
                        const torch::Tensor& features,
                        const torch::Tensor& index,
                        const torch::Tensor& own = {});

 private:
  torch::Tensor weight_, bias_;
  Mlp rest_{nullptr};
};
TORCH_MODULE(GroupedMlp);

/** Set abstraction (PointNet++): groups of a finer grid around nodes of a coarser one, MLP,
 * maximum. */
class SetConvImpl : public torch::nn::Module
{
 public:
  /** \param spacing angle between nodes, the unit of the offsets [rad] */
  SetConvImpl(std::int64_t in, const Sizes& mlp, double spacing);
  /** \param features [M, in], or undefined for in = 0. \return [N, mlp.back()]. */
  torch::Tensor forward(const torch::Tensor& features,
                        const ScanTensors::Level& from,
                        const ScanTensors::Level& to,
                        const Window& window);

 private:
  double spacing_;
  GroupedMlp mlp_{nullptr};
};
TORCH_MODULE(SetConv);

/** Cost volume output for each point of scan 1. */
struct Correlation
{
  torch::Tensor embedding;  //!< [N, C] the correlation features E
  torch::Tensor normal;     //!< [N, 3] attention-weighted normals of the candidates
  torch::Tensor offset;     //!< [N]; normal . p - offset is the point-to-plane residual [m]
  torch::Tensor target;     //!< [N, 3] soft correspondence
  torch::Tensor valid;      //!< [N] 1 for points with a candidate
};

/** Attentive cost volume (PWCLO-Net): attention over the nearest points of scan 2, then over
 * neighbours in scan 1. */
class AttentiveCostVolumeImpl : public torch::nn::Module
{
 public:
  /** \param hidden, out numbers of channels \param candidates number of nearest points kept of a
   * window */
  AttentiveCostVolumeImpl(std::int64_t features,
                          std::int64_t hidden,
                          std::int64_t out,
                          std::int64_t half_rows,
                          std::int64_t half_cols,
                          std::int64_t candidates,
                          double spacing);
  /** \param warped [N, 3] points and \param warped_normal [N, 3] normals of scan 1, transformed by
   * the current pose \param level pyramid level of scan 2 \param patch neighbours within scan 1's
   * grid */
  Correlation forward(const torch::Tensor& warped,
                      const torch::Tensor& warped_normal,
                      const torch::Tensor& valid,
                      const torch::Tensor& features1,
                      const ScanTensors& scan2,
                      std::size_t level,
                      const torch::Tensor& features2,
                      const Window& patch);

 private:
  std::int64_t half_rows_, half_cols_, candidates_;
  double spacing_;
  Mlp own_{nullptr}, embed_rest_{nullptr}, attend_{nullptr}, patch_attend_{nullptr};
  GroupedMlp embed_{nullptr}, patch_embed_{nullptr};
};
TORCH_MODULE(AttentiveCostVolume);

/** Set upconv (PWCLO-Net): coarse features to a finer grid, concatenated with the finer features.
 */
class SetUpConvImpl : public torch::nn::Module
{
 public:
  SetUpConvImpl(std::int64_t coarse, std::int64_t fine, std::int64_t out, double spacing);
  torch::Tensor forward(const torch::Tensor& coarse_features,
                        const ScanTensors::Level& coarse,
                        const torch::Tensor& fine_features,
                        const ScanTensors::Level& fine,
                        const Window& window);

 private:
  double spacing_;
  GroupedMlp gather_{nullptr};
  Mlp fusion_{nullptr};
};
TORCH_MODULE(SetUpConv);

/** Mask logits per point. */
struct MaskLogits
{
  torch::Tensor is_static;  //!< [N]; its sigmoid is the static confidence
  torch::Tensor quality;    //!< [N]; its sigmoid is the correspondence's relative precision
};

/** The dynamic mask network (paper Fig. 4, Eq. 1) and its two ablations. */
class DynamicMaskImpl : public torch::nn::Module
{
 public:
  DynamicMaskImpl(DyloMask kind, std::int64_t embedding, std::int64_t features);
  MaskLogits forward(const torch::Tensor& embedding,
                     const torch::Tensor& features,
                     const torch::Tensor& valid);

 private:
  DyloMask kind_;
  Mlp spatial_{nullptr}, channel_{nullptr}, mask_{nullptr};
};
TORCH_MODULE(DynamicMask);

/** Mask weights M = softmax over points of log sigmoid(is_static) + log sigmoid(quality), sum 1,
 * [N]. Zero for invalid points. */
[[nodiscard]] torch::Tensor maskWeights(const MaskLogits& logits, const torch::Tensor& valid);
}  // namespace dyslam
