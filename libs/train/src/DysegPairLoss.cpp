// SPDX-License-Identifier: BSD-3-Clause
// The loss of a pair of scans: forward pass, and the losses of its stages.
#include <dyslam/train/DysegLosses.h>
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace nnf = torch::nn::functional;
using torch::Tensor;

void DysegLossOptions::describe(OptionsVisitor& v)
{
  v.integer("iterations", iterations, 1, 12, "iterations of the flow update in training");
  v.real("decay", decay, 0.1, 1,
         "weight of the flow error after an update, relative to the next update's");
  v.integer("points", points, 16, 100000, "number of points of a pair in the point loss");
  v.real("first_noise", first_noise, 0, 5,
         "sigma of the error of the ego-motion that guides the coarse matching in training [m]");
  v.real("second_noise", second_noise, 0, 5,
         "sigma of the error of the ego-motion that gives the static flow in training [m]");
}

namespace
{
constexpr double matching_weight = 0.5;
constexpr double flow_weight = 1.0;
constexpr double upsampled_weight = 0.3;
constexpr double static_probability_weight = 0.3;

Tensor rowsOf(const std::vector<Eigen::Vector2f>& values)
{
  return torch::from_blob(const_cast<Eigen::Vector2f*>(values.data()),
                          {static_cast<std::int64_t>(values.size()), 2})
      .clone();
}

Tensor flagsOf(const std::vector<std::uint8_t>& labels, std::uint8_t value)
{
  return torch::from_blob(const_cast<std::uint8_t*>(labels.data()),
                          {static_cast<std::int64_t>(labels.size())}, torch::kUInt8)
      .eq(static_cast<int>(value));
}

PlanarMotion perturbed(PlanarMotion motion, double noise, RandomDraws& draws)
{
  // With outliers, as in the errors of fits.
  const double scale = noise * (draws.chance(0.15) ? 2.5 : 1);
  const auto [x, y] = draws.normals<2>({scale, scale});
  motion.translation += Eigen::Vector2d(x, y);
  motion.yaw += draws.normal(0.026 * scale);
  return motion;
}

/** Sampled points, and the number of points that each represents. */
struct DrawnPoints
{
  std::vector<std::int32_t> which;
  std::vector<float> weight;
};

/** Samples moving, likely misclassified static and other points, a third each where possible. */
DrawnPoints drawPoints(const DysegSample& sample,
                       const BevScan& scan,
                       const std::vector<float>& cell_logit,
                       const DysegCells& cells,
                       int count,
                       RandomDraws& draws)
{
  std::vector<std::int32_t> moving;
  std::vector<std::int32_t> hard;
  std::vector<std::int32_t> other;
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const auto label = sample.label[scan.source[i]];
    if (label == DysegSample::ignored_point)
    {
      continue;
    }
    const bool suspected =
        cell_logit[static_cast<std::size_t>(cells.level.quarter.row_of_point[i])] > -2;
    (label == DysegSample::moving_point ? moving
     : suspected                        ? hard
                                        : other)
        .push_back(static_cast<std::int32_t>(i));
  }
  DrawnPoints chosen;
  for (auto* group : {&moving, &hard, &other})
  {
    const auto wanted = std::min(group->size(), static_cast<std::size_t>(count / 3));
    for (std::size_t k = 0; k < wanted; ++k)
    {
      std::swap((*group)[k], (*group)[k + draws.below(group->size() - k)]);
      chosen.which.push_back((*group)[k]);
      chosen.weight.push_back(static_cast<float>(group->size()) / static_cast<float>(wanted));
    }
  }
  return chosen;
}

/** Norms of the rows of an N x 2 tensor, bounded away from 0, where the gradient is undefined. */
Tensor lengthOf(const Tensor& rows)
{
  return rows.square().sum(1).add(1e-4).sqrt();
}

/** Offsets, set to NaN for cells at whose target the past scan has no points to match. */
Tensor seenOffsets(const std::vector<Eigen::Vector2f>& flow,
                   const std::vector<Eigen::Vector2f>& places,
                   const PlanarMotion& centre,
                   const BevScan& past,
                   int factor)
{
  const int side = past.cells / factor;
  const float size = past.cell_size * static_cast<float>(factor);
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(side * side), 0);
  for (const auto c : past.cell)
  {
    seen[static_cast<std::size_t>(c / past.cells / factor * side + c % past.cells / factor)] = 1;
  }
  std::vector<Eigen::Vector2f> offset(
      flow.size(), Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (std::size_t i = 0; i < flow.size(); ++i)
  {
    if (!flow[i].allFinite())
    {
      continue;
    }
    const Eigen::Vector2f to = (places[i] + flow[i] - past.corner) / size;
    const int x = static_cast<int>(std::floor(to.x()));
    const int y = static_cast<int>(std::floor(to.y()));
    if (x >= 0 && y >= 0 && x < side && y < side &&
        seen[static_cast<std::size_t>(y * side + x)] != 0)
    {
      offset[i] = (flow[i] - centre.flowAt(places[i])) / size;
    }
  }
  return rowsOf(offset);
}

/** Forward pass of one pair: scans, network output and ground truth. */
struct ForwardPass
{
  ForwardPass(const DysegSample& pair,
              const DysegLossOptions& loss,
              const BevOptions& grid,
              const Eigen::Vector2f& centre)
      : sample(pair),
        options(loss),
        current(makeBevScan(pair.current, grid, centre)),
        past(makeBevScan(pair.past, grid, centre))
  {
  }

  const DysegSample& sample;
  const DysegLossOptions& options;
  BevScan current, past;
  PlanarMotion ego;
  TeacherMotions guide;
  DysegEncoding a, b;  //!< encodings of the current and the past scan
  DysegMatch match;
  DysegCellOutput out;
  DysegCellTruth truth;  //!< truth of the cells at 1/4
  Tensor moving;         //!< moving flags of the cells at 1/4
  int radius = 0;        //!< radius of the correlation windows [cells]

  [[nodiscard]] const DysegCells& cells() const { return *a.cells; }
  [[nodiscard]] torch::Device device() const { return out.logit.device(); }
};

/** Cross-entropy of the correlation windows at 1/8 and 1/4 against the true offsets. */
Tensor matchingLoss(const ForwardPass& pass)
{
  const DysegCells& cells = pass.cells();
  const auto coarse = cellTruth(pass.sample, pass.current, cells.level.eighth.row_of_point,
                                cells.eighth_centre, pass.ego);
  const auto coarse_offset =
      seenOffsets(coarse.flow, cells.eighth_centre, PlanarMotion(), pass.past, 8);
  const auto offset =
      seenOffsets(pass.truth.flow, cells.quarter_centre, pass.guide.coarse, pass.past, 4);
  return matching_weight *
         (correlationLoss(pass.match.coarse_correlation, coarse_offset.to(pass.device()),
                          flagsOf(coarse.label, DysegSample::moving_point).to(pass.device()),
                          pass.radius) +
          correlationLoss(pass.match.correlation, offset.to(pass.device()), pass.moving,
                          pass.radius));
}

/** Loss of the flow after each update, relative to the static flow that the network was given;
 * without a value where no cell's flow is known. */
Tensor flowLoss(const ForwardPass& pass)
{
  std::vector<Eigen::Vector2f> residual(pass.truth.flow.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
  {
    residual[i] = pass.truth.flow[i] - pass.guide.fine.flowAt(pass.cells().quarter_centre[i]);
  }
  const auto residual_truth = rowsOf(residual).to(pass.device());
  // Motion beyond the windows cannot be matched.
  const float farthest = (static_cast<float>(pass.radius) + 0.5F) * 4 * pass.current.cell_size;
  const auto known = residual_truth.isfinite().all(1) & residual_truth.abs().le(farthest).all(1);
  const auto index = known.nonzero().squeeze(1);
  if (index.numel() == 0)
  {
    return {};
  }
  auto loss = torch::zeros({}, pass.out.logit.options());
  double weight = 1;
  for (auto r = pass.out.residual.rbegin(); r != pass.out.residual.rend();
       ++r, weight *= pass.options.decay)
  {
    loss = loss + weight * balancedMean(lengthOf(r->index_select(0, index) -
                                                 residual_truth.index_select(0, index)),
                                        pass.moving.index_select(0, index));
  }
  return loss;
}

struct CellLosses
{
  Tensor static_probability;  //!< loss of the appearance prior
  Tensor cell;
};

/** Without values where no cell has a label. */
CellLosses cellLosses(const ForwardPass& pass)
{
  const auto labelled = flagsOf(pass.truth.label, DysegSample::ignored_point)
                            .logical_not()
                            .to(pass.device())
                            .nonzero()
                            .squeeze(1);
  if (labelled.numel() == 0)
  {
    return {};
  }
  const auto label = pass.moving.index_select(0, labelled);
  const auto each = nnf::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone);
  const auto error = nnf::binary_cross_entropy_with_logits(pass.out.logit.index_select(0, labelled),
                                                           label.to(torch::kFloat32), each);
  const auto static_probability_error = nnf::binary_cross_entropy_with_logits(
      pass.a.static_logit.index_select(0, labelled), label.logical_not().to(torch::kFloat32), each);
  return {balancedMean(static_probability_error, label),
          0.5 * balancedMean(error, label) + error.mean()};
}

struct PointLosses
{
  Tensor point;
  Tensor upsampled;  //!< loss of the flow at the points; undefined if no flow is known
};

/** Without values where no point has a label. */
PointLosses pointLosses(DysegNet& net, const ForwardPass& pass, RandomDraws& draws)
{
  const auto logits = pass.out.logit.detach().cpu().contiguous();
  const std::vector<float> cell_logit(logits.data_ptr<float>(),
                                      logits.data_ptr<float>() + logits.numel());
  const auto drawn =
      drawPoints(pass.sample, pass.current, cell_logit, pass.cells(), pass.options.points, draws);
  const auto& which = drawn.which;
  if (which.empty())
  {
    return {};
  }
  std::vector<std::uint8_t> label;
  std::vector<Eigen::Vector2f> residual;
  for (const auto w : which)
  {
    const auto i = static_cast<std::size_t>(w);
    label.push_back(pass.sample.label[pass.current.source[i]]);
    const Eigen::Vector2f at = pass.current.points[i].head<2>();
    residual.emplace_back(pass.sample.flow[pass.current.source[i]] - pass.guide.fine.flowAt(at));
  }
  const auto logit =
      net->segmentPoints(pass.current, pass.a, pass.b, pass.past.rays, pass.out, which);
  const auto moving = flagsOf(label, DysegSample::moving_point).to(pass.device());
  // Loss with balanced classes plus loss with true class frequencies: high recall with few false
  // positives.
  const auto weight = torch::tensor(drawn.weight).to(pass.device());
  const auto error = nnf::binary_cross_entropy_with_logits(
      logit, moving.to(torch::kFloat32),
      nnf::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone));
  PointLosses losses;
  losses.point = 0.5 * error.mean() + 2.0 * torch::dot(error, weight) / weight.sum();
  if (moving.any().item<bool>())
  {
    losses.point = losses.point + lovaszLoss(logit, moving, weight);
  }
  const auto fine = rowsOf(residual).to(pass.device());
  const auto known = fine.isfinite().all(1).nonzero().squeeze(1);
  if (known.numel() > 0)
  {
    const auto off = lengthOf(
        (net->pointFlow(pass.current, pass.a, pass.out, which) - fine).index_select(0, known));
    losses.upsampled = balancedMean(off, moving.index_select(0, known));
  }
  return losses;
}

/** Adds a loss to the total, if it is defined. \return its value, else 0 */
double addTo(Tensor& total, const Tensor& loss, double weight)
{
  if (!loss.defined())
  {
    return 0;
  }
  total = total + weight * loss;
  return loss.item<double>();
}
}  // namespace

DysegLoss dysegLoss(DysegNet& net,
                    const DysegSample& sample,
                    const BevOptions& grid,
                    const Eigen::Vector2f& centre,
                    const DysegLossOptions& options,
                    RandomDraws& draws)
{
  DysegLoss loss;
  ForwardPass pass(sample, options, grid, centre);
  if (pass.current.size() < 50 || pass.past.size() < 50)
  {
    return loss;
  }
  pass.ego = PlanarMotion::fromPose(sample.T_past_current);
  pass.guide.coarse = perturbed(pass.ego, options.first_noise, draws);
  pass.guide.fine = perturbed(pass.ego, options.second_noise, draws);
  pass.radius = net->options().radius;
  pass.a = net->encode(pass.current);
  pass.b = net->encode(pass.past);
  pass.match = net->match(pass.current, pass.a, pass.b, &pass.guide);
  pass.out = net->segmentCells(pass.current, pass.a, pass.b, pass.guide.fine, options.iterations);
  pass.truth = cellTruth(sample, pass.current, pass.cells().level.quarter.row_of_point,
                         pass.cells().quarter_centre, pass.ego);
  pass.moving = flagsOf(pass.truth.label, DysegSample::moving_point).to(pass.device());

  loss.total = matchingLoss(pass);
  loss.matching = loss.total.item<double>();
  loss.flow = addTo(loss.total, flowLoss(pass), flow_weight);
  const CellLosses of_cells = cellLosses(pass);
  loss.static_probability =
      addTo(loss.total, of_cells.static_probability, static_probability_weight);
  loss.cell = addTo(loss.total, of_cells.cell, 1);
  const PointLosses of_points = pointLosses(net, pass, draws);
  loss.point = addTo(loss.total, of_points.point, 1);
  (void)addTo(loss.total, of_points.upsampled, upsampled_weight);
  return loss;
}
}  // namespace dyslam
