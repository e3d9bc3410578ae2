// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloNetwork.h>
#include <dyslam/nets/Grouping.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace dyslam
{
namespace
{
constexpr std::size_t coarse_stages = 4;

/** Pyramid level of a coarse stage: 3 for stage 0 (first cost volume), then 3, 2 and 1. */
std::size_t coarseLevel(std::size_t stage)
{
  return stage == 0 ? 3 : 4 - stage;
}

/** Approximate angle between the nodes of each level [rad]. */
constexpr std::array<double, PreparedScan::level_count> spacing = {0.02, 0.05, 0.1, 0.2, 0.4};

/** Largest number of fine stages, and the motionSize() of a step below which they have converged
 * [m]. */
constexpr int max_fine_passes = 8;
constexpr double convergence_step = 0.008;

/** Number of channels: PWCLO-Net's `size` times `width`, at least 4. */
std::int64_t scaled(double width, std::int64_t size)
{
  return std::max<std::int64_t>(4, std::lround(width * static_cast<double>(size)));
}

std::int64_t featureSize(double width, std::size_t level)
{
  constexpr std::array<std::int64_t, 5> sizes = {0, 16, 32, 64, 128};
  return scaled(width, sizes[level]);
}

/** Input of the regression head in addition to the embedding: first moments of the motion implied
 * by a point's soft correspondence and surface, [N, moment_size], normalised to about 1. */
constexpr std::int64_t moment_size = 21;

torch::Tensor motionMoments(const torch::Tensor& warped, const Correlation& correlation)
{
  constexpr double lever = 20;  // typical range [m]
  const torch::Tensor& normal = correlation.normal;
  const torch::Tensor arm = warped / lever;
  const torch::Tensor flow = correlation.target - warped;
  const torch::Tensor along = normal * (correlation.offset - (normal * warped).sum(1)).unsqueeze(1);
  const torch::Tensor x = normal.slice(1, 0, 1);
  const torch::Tensor y = normal.slice(1, 1, 2);
  return torch::cat({flow, torch::cross(arm, flow, 1), along, torch::cross(arm, along, 1), arm,
                     x * normal, y * normal.slice(1, 1, 3), normal.slice(1, 2, 3).square()},
                    1);
}

torch::Tensor nodeGeometry(const ScanTensors::Level& level)
{
  const torch::Tensor range = level.xyz.norm(2, 1, true);
  return torch::cat({level.normal, level.planarity.unsqueeze(1), level.xyz / (range + 1),
                     torch::log1p(range) / 4},
                    1);
}
}  // namespace

DyloNetworkImpl::DyloNetworkImpl(const DyloNetworkOptions& options) : options_(options)
{
  const double w = options.width;
  const auto size = [w](std::int64_t full) { return scaled(w, full); };
  const std::vector<std::vector<std::int64_t>> mlps = {{size(8), size(8), size(16)},
                                                       {size(16), size(16), size(32)},
                                                       {size(32), size(32), size(64)},
                                                       {size(64), size(64), size(128)}};
  for (std::size_t l = 0; l < mlps.size(); ++l)
  {
    const std::int64_t in = l == 0 ? 0 : featureSize(w, l);
    encoder_.push_back(
        register_module("encoder" + std::to_string(l + 1), SetConv(in, mlps[l], spacing[l + 1])));
  }
  first_fusion_ = register_module("first_join", Mlp(Sizes{size(16) + 8, size(16)}));

  const std::int64_t embedding = size(64);
  const std::int64_t hidden = size(128);
  first_cost_ = register_module("first_cost", AttentiveCostVolume(featureSize(w, 3), hidden,
                                                                  embedding, 2, 3, 32, spacing[3]));
  cost_down_ =
      register_module("cost_down", SetConv(embedding, Sizes{hidden, embedding}, spacing[4]));
  coarsest_mask_ =
      register_module("coarsest_mask", DynamicMask(options.mask, embedding, featureSize(w, 4)));
  cost_up_ =
      register_module("cost_up", SetUpConv(embedding + featureSize(w, 4),
                                           embedding + featureSize(w, 3), embedding, spacing[4]));
  for (std::size_t stage = 0; stage < coarse_stages; ++stage)
  {
    addCoarseStage(stage, embedding, hidden);
  }
  isotropic_ = register_parameter("isotropic", torch::tensor({-2.F, -4.F, -6.F, -8.F}));
  noise_ = register_parameter("noise", torch::tensor({-0.7F, -1.F, -1.5F, -2.F, -3.F}));
  if (options.head == DyloHead::gauss_newton)
  {
    fine_embed_ = register_module(
        "fine_embed",
        Mlp(Sizes{embedding + featureSize(w, 1) + Surfaces::feature_size, embedding, embedding}));
    fine_mask_ =
        register_module("fine_mask", DynamicMask(options.mask, embedding, featureSize(w, 1)));
  }
}

void DyloNetworkImpl::addCoarseStage(std::size_t stage, std::int64_t embedding, std::int64_t hidden)
{
  const double w = options_.width;
  const std::size_t level = coarseLevel(stage);
  mask_.push_back(register_module("mask" + std::to_string(stage),
                                  DynamicMask(options_.mask, embedding, featureSize(w, level))));
  if (options_.head == DyloHead::regression)
  {
    Mlp head(Sizes{embedding + moment_size, hidden, 7}, true);
    head->scaleOutput(0.01);
    regression_.push_back(register_module("regression" + std::to_string(stage), head));
  }
  if (stage == 0)
  {
    return;  // stage 0 has the first cost volume
  }
  const std::string name = std::to_string(level);
  cost_.push_back(register_module(
      "cost" + name,
      AttentiveCostVolume(featureSize(w, level), hidden, embedding, 1, 2, 6, spacing[level])));
  up_.emplace_back(nullptr);
  if (level < 3)
  {
    up_.back() = register_module(
        "up" + name, SetUpConv(embedding, featureSize(w, level), embedding, spacing[level + 1]));
  }
  fusion_.push_back(register_module("join" + name, Mlp(Sizes{2 * embedding, hidden, embedding})));
}

const Window& DyloNetworkImpl::window(
    std::size_t from, std::size_t to, const EncodedScan& scan, std::int64_t rows, std::int64_t cols)
{
  const ScanTensors::Level& source = scan.scan.levels[from];
  const ScanTensors::Level& target = scan.scan.levels[to];
  const auto key = std::make_tuple(source.rows, static_cast<std::int64_t>(from),
                                   static_cast<std::int64_t>(to), rows, cols);
  const auto found = windows_.find(key);
  if (found != windows_.end() && found->second.index.device() == target.xyz.device())
  {
    return found->second;
  }
  windows_[key] = windowBetween(source.rows, source.cols, target.rows, target.cols, rows, cols,
                                target.xyz.device());
  return windows_[key];
}

EncodedScan DyloNetworkImpl::encode(const ScanTensors& scan)
{
  EncodedScan encoded;
  encoded.scan = scan;
  constexpr std::array<std::array<std::int64_t, 2>, 4> windows = {{{4, 8}, {4, 8}, {4, 4}, {4, 4}}};
  for (std::size_t l = 1; l < PreparedScan::level_count; ++l)
  {
    const Window& around = window(l - 1, l, encoded, windows[l - 1][0], windows[l - 1][1]);
    torch::Tensor x = encoder_[l - 1]->forward(encoded.features[l - 1], scan.levels[l - 1],
                                               scan.levels[l], around);
    if (l == 1)
    {
      x = first_fusion_->forward(torch::cat({x, nodeGeometry(scan.levels[1])}, 1));
    }
    encoded.features[l] = x;
  }
  return encoded;
}

DyloStage DyloNetworkImpl::poseStage(std::size_t stage,
                                     std::size_t level,
                                     const PoseTensors& start,
                                     const torch::Tensor& warped,
                                     const Correlation& correlation,
                                     const MaskLogits& logits,
                                     const torch::Tensor& embedding)
{
  DyloStage result;
  result.level = level;
  result.logits = logits;
  result.valid = correlation.valid;
  result.weight = maskWeights(logits, correlation.valid);
  result.normal = correlation.normal;
  result.offset = correlation.offset;
  result.target = correlation.target;
  result.noise = noise_[static_cast<std::int64_t>(stage)].exp();
  if (options_.head == DyloHead::regression)
  {
    const torch::Tensor input = torch::cat({embedding, motionMoments(warped, correlation)}, 1);
    const torch::Tensor pooled = (input * result.weight.unsqueeze(1)).sum(0, true);
    const torch::Tensor out = regression_[stage]->forward(pooled).squeeze(0);
    const torch::Tensor quaternion =
        out.slice(0, 0, 4) + torch::tensor({1.F, 0.F, 0.F, 0.F}, out.options());
    const PoseTensors update = {rotationOfQuaternion(quaternion), out.slice(0, 4, 7)};
    result.pose = update * start;
    return result;
  }
  const GaussNewtonStep step =
      gaussNewtonStep({warped, correlation.normal, correlation.offset, correlation.target,
                       result.weight, isotropic_[static_cast<std::int64_t>(stage)].exp()});
  result.pose = step.update * start;
  result.normal_matrix = step.normal_matrix;
  return result;
}

DyloStage DyloNetworkImpl::coarseStage(std::size_t stage,
                                       const EncodedScan& scan1,
                                       const EncodedScan& scan2,
                                       const PoseTensors& start,
                                       std::size_t level_before,
                                       torch::Tensor& embedding)
{
  const std::size_t level = coarseLevel(stage);
  const ScanTensors::Level& nodes = scan1.scan.levels[level];
  const torch::Tensor& features = scan1.features[level];
  const torch::Tensor warped = start.apply(nodes.xyz);
  const torch::Tensor normal = torch::matmul(nodes.normal, start.rotation.t());
  AttentiveCostVolume& cost = stage == 0 ? first_cost_ : cost_[stage - 1];
  const Correlation correlation =
      cost->forward(warped, normal, nodes.valid, features, scan2.scan, level, scan2.features[level],
                    window(level, level, scan1, 2, 2));
  if (stage == 0)
  {
    const ScanTensors::Level& coarsest = scan1.scan.levels[4];
    const torch::Tensor down =
        cost_down_->forward(correlation.embedding, nodes, coarsest, window(3, 4, scan1, 4, 4));
    const MaskLogits mask = coarsest_mask_->forward(down, scan1.features[4], coarsest.valid);
    const torch::Tensor masked = down * torch::sigmoid(mask.is_static).unsqueeze(1);
    embedding = cost_up_->forward(torch::cat({masked, scan1.features[4]}, 1), coarsest,
                                  torch::cat({correlation.embedding, features}, 1), nodes,
                                  window(4, 3, scan1, 2, 4));
  }
  else
  {
    const torch::Tensor up =
        level_before == level
            ? embedding
            : up_[stage - 1]->forward(embedding, scan1.scan.levels[level_before], features, nodes,
                                      window(level_before, level, scan1, 2, 4));
    embedding = fusion_[stage - 1]->forward(torch::cat({correlation.embedding, up}, 1));
  }
  const MaskLogits logits = mask_[stage]->forward(embedding, features, nodes.valid);
  DyloStage result = poseStage(stage, level, start, warped, correlation, logits, embedding);
  result.points = nodes.xyz;
  return result;
}

std::vector<DyloStage> DyloNetworkImpl::forward(const EncodedScan& scan1,
                                                const EncodedScan& scan2,
                                                const PoseTensors& start,
                                                const DyloPrior* prior)
{
  std::vector<DyloStage> stages;
  PoseTensors pose = start;
  torch::Tensor embedding;
  for (std::size_t stage = 0; stage < coarse_stages; ++stage)
  {
    const std::size_t level_before = stage == 0 ? 0 : stages.back().level;
    stages.push_back(coarseStage(stage, scan1, scan2, pose, level_before, embedding));
    pose = stages.back().pose.detached();
  }
  if (options_.head == DyloHead::regression || options_.fine_passes == 0)
  {
    return stages;
  }
  if (torch::GradMode::is_enabled())
  {
    for (int pass = 0; pass < options_.fine_passes; ++pass)
    {
      stages.push_back(fineStage(scan1, scan2, pose, embedding, nullptr));
      pose = stages.back().pose.detached();
    }
    stages.push_back(denseStage(scan1, scan2, stages.back(), nullptr));
    return stages;
  }
  bool converged = false;
  for (int pass = 0; pass < max_fine_passes && !converged; ++pass)
  {
    const Pose before = pose.toPose();
    stages.push_back(fineStage(scan1, scan2, pose, embedding, prior));
    pose = stages.back().pose;
    converged = motionSize(logSE3(before.inverse() * pose.toPose())) < convergence_step;
  }
  stages.push_back(denseStage(scan1, scan2, stages.back(), prior));
  return stages;
}
}  // namespace dyslam
