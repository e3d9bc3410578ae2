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
/** The level of points that a stage of the search from coarse to fine looks at. */
std::size_t coarseLevel(std::size_t stage)
{
  return stage == 0 ? 3 : 4 - stage;
}

/** Angle between nodes of each level [rad], about. */
constexpr std::array<double, PreparedScan::level_count> spacing = {0.02, 0.05, 0.1, 0.2, 0.4};

/** Steps against the full-resolution image, at most, until one is as short as this [m]. */
constexpr int most_fine_passes = 8;
constexpr double settled_step = 0.008;

/** Of the last pass, over points of level 0 [m]. */
constexpr double dense_kernel = 0.1;
constexpr double dense_thickness = 0.05;

/** Also of the last pass: how much level surfaces together may count, over all others. Of the way
 * ahead they tell but what their errors make up. */
constexpr double level_share = 1.5;
constexpr double level_cosine = 0.9;  //!< of their normals with the sensor's z axis
constexpr double least_level_weight = 0.02;

/** Full sizes, as PWCLO-Net's. */
std::int64_t scaled(double width, std::int64_t size)
{
  return std::max<std::int64_t>(4, std::lround(width * static_cast<double>(size)));
}

std::int64_t featureSize(double width, std::size_t level)
{
  constexpr std::array<std::int64_t, 5> sizes = {0, 16, 32, 64, 128};
  return scaled(width, sizes[level]);
}

/** What the regression head reads beside the embedding: first moments of the motion that a point's
 * soft correspondence and surface ask for, [N, reading_size]; about 1 in size. */
constexpr std::int64_t reading_size = 21;

torch::Tensor motionReadings(const torch::Tensor& warped, const Correlation& correlation)
{
  constexpr double lever = 20;  // m, typical range
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

/** Points of a scan, deskewed by `motion` instead of by what it was; to first order of the
 * difference. */
torch::Tensor swept(const torch::Tensor& xyz,
                    const torch::Tensor& phase,
                    const EncodedScan& scan,
                    const Pose& motion)
{
  if (!phase.defined())
  {
    return xyz;
  }
  const Vector6 more = logSE3(scan.T_sweep.inverse() * motion);
  const torch::Tensor shift = torch::tensor({more[0], more[1], more[2]}, xyz.options());
  const torch::Tensor turn = torch::tensor(
      {0.0, more[5], -more[4], -more[5], 0.0, more[3], more[4], -more[3], 0.0}, xyz.options());
  return torch::addcmul(xyz, phase.unsqueeze(1), torch::addmm(shift, xyz, turn.view({3, 3})));
}

torch::Tensor sweptBy(const EncodedScan& scan, std::size_t level, const Pose& motion)
{
  return swept(scan.scan.levels[level].xyz, scan.phase[level], scan, motion);
}

/** `start`, moved by the step that the prior allows. */
PoseTensors heeding(const DyloPrior& prior,
                    const Alignment& alignment,
                    const GaussNewtonStep& step,
                    const PoseTensors& start)
{
  const torch::Tensor residual = (alignment.normal * alignment.points).sum(1) - alignment.offset;
  const double rmse = std::sqrt((alignment.weight * residual.square()).sum().item<double>());
  const double points = 1 / std::max(alignment.weight.square().sum().item<double>(), 1e-9);
  const torch::Tensor normal = step.normal_matrix.to(torch::kCPU, torch::kDouble).contiguous();
  const Matrix6 measured =
      measuredPrecision(rmse, points, prior.correlated_points) *
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(normal.data_ptr<double>());
  const Pose T = start.toPose();
  const Vector6 moved = jointStep(prior, T, logSE3(step.update.toPose()), measured);
  return PoseTensors::from(expSE3(moved) * T, start.rotation.options());
}

/** Share of its node's weight that a point keeps in the dense stage. */
torch::Tensor closeness(const Surfaces& surfaces, const torch::Tensor& residual)
{
  const torch::Tensor off = (residual / dense_kernel).square() + 1;
  const torch::Tensor thick = (surfaces.thickness / dense_thickness).square() + 1;
  return surfaces.valid / (off.square() * thick);
}

/** `weight`, less for level surfaces where they outweigh the others. */
torch::Tensor balanced(const torch::Tensor& weight, const torch::Tensor& normal)
{
  const torch::Tensor level = normal.select(1, 2).abs().gt(level_cosine).to(weight.dtype());
  const torch::Tensor of_level = (weight * level).sum().detach();
  const torch::Tensor of_others = (weight * (1 - level)).sum().detach();
  const torch::Tensor share =
      (level_share * of_others / of_level.clamp_min(1e-9)).clamp(least_level_weight, 1);
  return weight * (1 - (1 - share) * level);
}

/** Every other column of a level's nodes. \param of_nodes [N] or [N, 3]. */
torch::Tensor everyOther(const torch::Tensor& of_nodes,
                         const ScanTensors::Level& level,
                         std::int64_t first)
{
  std::vector<std::int64_t> halved = of_nodes.sizes().vec();
  halved[0] /= 2;
  return of_nodes.reshape({level.rows, level.cols / 2, 2, -1}).select(2, first).reshape(halved);
}

/** Points of one scan on the surfaces of the other; as in Alignment, weights not yet normalised. */
struct DenseMatch
{
  torch::Tensor points, normal, offset, weight;
};

/** Points of scan 1 on surfaces of scan 2. \param fine the weights of scan 1's nodes of level 1. */
DenseMatch matchOnto(const EncodedScan& scan1,
                     const ScanTensors& scan2,
                     const PoseTensors& start,
                     const torch::Tensor& fine)
{
  const ScanTensors::Level& nodes = scan1.scan.levels[0];
  const ScanTensors::Level& parents = scan1.scan.levels[1];
  const torch::Tensor points = everyOther(sweptBy(scan1, 0, start.toPose()), nodes, 0);
  const torch::Tensor warped = start.apply(points);
  const Surfaces surfaces = surfacesAround(warped, {}, everyOther(nodes.valid, nodes, 0), scan2);
  const torch::Tensor residual = (surfaces.normal * warped).sum(1) - surfaces.offset;
  const torch::Tensor of_parents = fine.reshape({parents.rows, 1, parents.cols, 1})
                                       .expand({parents.rows, nodes.rows / parents.rows,
                                                parents.cols, nodes.cols / 2 / parents.cols})
                                       .reshape({-1});
  return {warped, surfaces.normal, surfaces.offset, of_parents * closeness(surfaces, residual)};
}

/** The other way round: points of scan 2 on surfaces of scan 1, which a step moves; so rows and
 * normals are turned round. */
DenseMatch matchBack(const EncodedScan& scan1,
                     const ScanTensors& scan2,
                     const PoseTensors& start,
                     const torch::Tensor& fine)
{
  ScanTensors image1 = scan1.scan;
  image1.image_xyz = swept(image1.image_xyz, scan1.image_phase, scan1, start.toPose());
  const ScanTensors::Level& nodes = scan2.levels[0];
  const torch::Tensor points = everyOther(nodes.xyz, nodes, 1);
  const torch::Tensor seen = torch::matmul(points - start.translation, start.rotation);
  const Surfaces surfaces = surfacesAround(seen, {}, everyOther(nodes.valid, nodes, 1), image1);
  const torch::Tensor residual = (surfaces.normal * seen).sum(1) - surfaces.offset;
  const ScanTensors::Level& parents = image1.levels[1];
  const torch::Tensor parent =
      windowAround(seen, image1, parents.rows, parents.cols, 0, 0).index.squeeze(1);
  const torch::Tensor normal = -torch::matmul(surfaces.normal, start.rotation.t());
  return {points, normal, (normal * points).sum(1) - residual,
          fine.index_select(0, parent) * closeness(surfaces, residual)};
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
  first_join_ = register_module("first_join", Mlp(Sizes{size(16) + 8, size(16)}));

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
  // Stage 0 weighs level 3 by its own mask; the later ones are levels 3, 2 and 1.
  for (std::size_t stage = 0; stage < 4; ++stage)
  {
    const std::size_t level = stage == 0 ? 3 : 4 - stage;
    mask_.push_back(register_module("mask" + std::to_string(stage),
                                    DynamicMask(options.mask, embedding, featureSize(w, level))));
    if (options.head == DyloHead::regression)
    {
      Mlp head(Sizes{embedding + reading_size, hidden, 7}, true);
      head->scaleOutput(0.01);
      regression_.push_back(register_module("regression" + std::to_string(stage), head));
    }
    if (stage == 0)
    {
      continue;
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
    join_.push_back(register_module("join" + name, Mlp(Sizes{2 * embedding, hidden, embedding})));
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
      x = first_join_->forward(torch::cat({x, nodeGeometry(scan.levels[1])}, 1));
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
    const torch::Tensor said = torch::cat({embedding, motionReadings(warped, correlation)}, 1);
    const torch::Tensor pooled = (said * result.weight.unsqueeze(1)).sum(0, true);
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

DyloStage DyloNetworkImpl::fineStage(const EncodedScan& scan1,
                                     const EncodedScan& scan2,
                                     const PoseTensors& start,
                                     const torch::Tensor& embedding,
                                     const DyloPrior* prior)
{
  const ScanTensors::Level& nodes = scan1.scan.levels[1];
  const torch::Tensor points = sweptBy(scan1, 1, start.toPose());
  const torch::Tensor warped = start.apply(points);
  const torch::Tensor own_normal = torch::matmul(nodes.normal, start.rotation.t());
  const Surfaces surfaces = surfacesAround(warped, own_normal, nodes.valid, scan2.scan);

  DyloStage result;
  result.level = 1;
  result.points = points;
  result.valid = surfaces.valid;
  result.normal = surfaces.normal;
  result.offset = surfaces.offset;
  result.target = surfaces.target;
  result.noise = noise_[4].exp();
  const torch::Tensor joined =
      fine_embed_->forward(torch::cat({surfaces.features, embedding, scan1.features[1]}, 1));
  result.logits = fine_mask_->forward(joined, scan1.features[1], result.valid);
  result.weight = maskWeights(result.logits, result.valid);
  const Alignment alignment = {warped,        result.normal, result.offset,
                               result.target, result.weight, {}};
  const GaussNewtonStep step = gaussNewtonStep(alignment);
  result.pose = prior == nullptr ? step.update * start : heeding(*prior, alignment, step, start);
  result.normal_matrix = step.normal_matrix;
  return result;
}

DyloStage DyloNetworkImpl::denseStage(const EncodedScan& scan1,
                                      const EncodedScan& scan2,
                                      const DyloStage& fine,
                                      const DyloPrior* prior)
{
  const PoseTensors start = fine.pose.detached();
  const DenseMatch onto = matchOnto(scan1, scan2.scan, start, fine.weight);
  const DenseMatch back = matchBack(scan1, scan2.scan, start, fine.weight);
  const torch::Tensor normal = torch::cat({onto.normal, back.normal});
  const torch::Tensor weight = balanced(torch::cat({onto.weight, back.weight}), normal);
  const Alignment alignment = {torch::cat({onto.points, back.points}), normal,
                               torch::cat({onto.offset, back.offset}), {},
                               weight / weight.sum().clamp_min(1e-9),  {}};
  const GaussNewtonStep step = gaussNewtonStep(alignment);
  DyloStage result = fine;
  result.dense = true;
  result.pose = prior == nullptr ? step.update * start : heeding(*prior, alignment, step, start);
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
    embedding = join_[stage - 1]->forward(torch::cat({correlation.embedding, up}, 1));
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
  for (std::size_t stage = 0; stage < 4; ++stage)
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
  bool settled = false;
  for (int pass = 0; pass < most_fine_passes && !settled; ++pass)
  {
    const Pose before = pose.toPose();
    stages.push_back(fineStage(scan1, scan2, pose, embedding, prior));
    pose = stages.back().pose;
    settled = motionSize(logSE3(before.inverse() * pose.toPose())) < settled_step;
  }
  stages.push_back(denseStage(scan1, scan2, stages.back(), prior));
  return stages;
}
}  // namespace dyslam
