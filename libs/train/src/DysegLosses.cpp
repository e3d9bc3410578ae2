// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/DysegLosses.h>
#include <torch/torch.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyslam
{
namespace nnf = torch::nn::functional;
using torch::Tensor;

namespace
{
const Eigen::Vector2f unknown_flow =
    Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
constexpr int moving_points_needed = 3;
constexpr double matching_weight = 0.5;
constexpr double flow_weight = 1.0;
constexpr double upsampled_weight = 0.3;
constexpr double anchor_weight = 0.3;

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
}  // namespace

DysegCellTruth cellTruth(const DysegSample& sample,
                         const BevScan& scan,
                         const std::vector<std::int32_t>& row_of_point,
                         const std::vector<Eigen::Vector2f>& places,
                         const PlanarMotion& ego)
{
  struct Count
  {
    int still = 0;
    int moving = 0;
    int ignored = 0;
    int known = 0;
    Eigen::Vector2f flow = Eigen::Vector2f::Zero();
  };
  std::vector<Count> counts(places.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    Count& c = counts[static_cast<std::size_t>(row_of_point[i])];
    const auto from = scan.source[i];
    if (sample.label[from] == DysegSample::moving_point)
    {
      ++c.moving;
      if (sample.flow[from].allFinite())
      {
        ++c.known;
        c.flow += sample.flow[from];
      }
      continue;
    }
    (sample.label[from] == DysegSample::static_point ? c.still : c.ignored) += 1;
  }
  DysegCellTruth truth;
  for (std::size_t r = 0; r < counts.size(); ++r)
  {
    const Count& c = counts[r];
    const int all = c.still + c.moving + c.ignored;
    if (c.moving >= moving_points_needed || 3 * c.moving > all)
    {
      truth.label.push_back(DysegSample::moving_point);
      truth.flow.emplace_back(c.known > 0 ? Eigen::Vector2f(c.flow / static_cast<float>(c.known))
                                          : unknown_flow);
    }
    else if (c.moving == 0 && 5 * c.ignored <= all)
    {
      truth.label.push_back(DysegSample::static_point);
      truth.flow.push_back(ego.flowAt(places[r]));
    }
    else
    {
      truth.label.push_back(DysegSample::ignored_point);
      truth.flow.push_back(unknown_flow);
    }
  }
  return truth;
}

Tensor balancedMean(const Tensor& value, const Tensor& moving)
{
  auto sum = torch::zeros({}, value.options());
  for (const auto& part : {moving.logical_not(), moving})
  {
    const auto some = value.masked_select(part);
    if (some.numel() > 0)
    {
      sum = sum + some.mean();
    }
  }
  return sum;
}

Tensor correlationLoss(const Tensor& correlation,
                       const Tensor& offset,
                       const Tensor& moving,
                       int radius)
{
  const auto usable = (offset.abs().le(radius - 0.01).sum(1).eq(2));  // false for NaN
  const auto index = usable.nonzero().squeeze(1);
  if (index.numel() == 0)
  {
    return torch::zeros({}, correlation.options());
  }
  const auto at = offset.index_select(0, index) + radius;
  const auto low = at.floor();
  const auto part = at - low;
  const std::int64_t side = 2 * radius + 1;
  const auto log_probability = correlation.index_select(0, index).log_softmax(1);
  auto loss = torch::zeros({index.size(0)}, correlation.options());
  for (const int dy : {0, 1})
  {
    for (const int dx : {0, 1})
    {
      const auto x = part.select(1, 0);
      const auto y = part.select(1, 1);
      const auto share = (dx == 1 ? x : 1 - x) * (dy == 1 ? y : 1 - y);
      const auto bin = (low.select(1, 1) + dy).clamp_max(static_cast<double>(side - 1)) *
                           static_cast<double>(side) +
                       (low.select(1, 0) + dx).clamp_max(static_cast<double>(side - 1));
      loss =
          loss - share * log_probability.gather(1, bin.to(torch::kInt64).unsqueeze(1)).squeeze(1);
    }
  }
  return balancedMean(loss, moving.index_select(0, index));
}

Tensor lovaszLoss(const Tensor& logit, const Tensor& label, const Tensor& weight)
{
  if (logit.numel() == 0)
  {
    return torch::zeros({}, logit.options());
  }
  const auto truth = label.to(logit.dtype());
  const auto error = (truth - logit.sigmoid()).abs();
  const auto sorted = error.sort(0, true);
  const auto order = std::get<1>(sorted);
  const auto positive = (truth * weight).index_select(0, order);
  const auto negative = ((1 - truth) * weight).index_select(0, order);
  const auto intersection = positive.sum() - positive.cumsum(0);
  const auto united = (positive.sum() + negative.cumsum(0)).clamp_min(1e-9);
  auto jaccard = 1 - intersection / united;
  jaccard = torch::cat({jaccard.narrow(0, 0, 1), jaccard.diff()}, 0);
  return torch::dot(std::get<0>(sorted), jaccard);
}

void DysegLossOptions::describe(OptionsVisitor& v)
{
  v.integer("iterations", iterations, 1, 12, "flow updates in training");
  v.real("decay", decay, 0.1, 1, "weight of an update's flow against the next one's");
  v.integer("points", points, 16, 100000, "judged one by one in a pair");
  v.real("first_noise", first_noise, 0, 5, "m, error of the first motion in training");
  v.real("second_noise", second_noise, 0, 5, "m, error of the static flow in training");
}

namespace
{
PlanarMotion disturbed(PlanarMotion motion, double noise, RandomDraws& draws)
{
  // Now and then much worse, as fits are.
  const double scale = noise * (draws.chance(0.15) ? 2.5 : 1);
  motion.translation += Eigen::Vector2d(draws.normal(scale), draws.normal(scale));
  motion.yaw += draws.normal(0.026 * scale);
  return motion;
}

/** Some points, and for how many of the scan's points each of them stands. */
struct DrawnPoints
{
  std::vector<std::int32_t> which;
  std::vector<float> weight;
};

/** Moving and static points to judge, about as many of each where there are. */
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

/** NaN where the place a cell goes to was not seen in the past scan: nothing to match there. */
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
  std::vector<Eigen::Vector2f> offset(flow.size(), unknown_flow);
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
}  // namespace

DysegLoss dysegLoss(DysegNet& net,
                    const DysegSample& sample,
                    const BevOptions& grid,
                    const Eigen::Vector2f& centre,
                    const DysegLossOptions& options,
                    RandomDraws& draws)
{
  DysegLoss loss;
  const BevScan current = makeBevScan(sample.current, grid, centre);
  const BevScan past = makeBevScan(sample.past, grid, centre);
  if (current.size() < 50 || past.size() < 50)
  {
    return loss;
  }
  const PlanarMotion ego = PlanarMotion::fromPose(sample.T_past_current);
  DysegGuide guide;
  guide.first = disturbed(ego, options.first_noise, draws);
  guide.second = disturbed(ego, options.second_noise, draws);
  const int radius = net->options().radius;
  const auto a = net->encode(current);
  const auto b = net->encode(past);
  const DysegCells& cells = *a.cells;
  const auto match = net->match(current, a, b, &guide);
  const auto out = net->cells(current, a, b, guide.second, options.iterations);
  const auto device = out.logit.device();

  // Matching.
  const auto coarse_truth =
      cellTruth(sample, current, cells.level.eighth.row_of_point, cells.eighth_place, ego);
  const auto truth =
      cellTruth(sample, current, cells.level.quarter.row_of_point, cells.quarter_place, ego);
  const auto moving = flagsOf(truth.label, DysegSample::moving_point).to(device);
  const auto coarse_offset =
      seenOffsets(coarse_truth.flow, cells.eighth_place, PlanarMotion(), past, 8);
  const auto offset = seenOffsets(truth.flow, cells.quarter_place, guide.first, past, 4);
  auto total =
      matching_weight *
      (correlationLoss(match.coarse_correlation, coarse_offset.to(device),
                       flagsOf(coarse_truth.label, DysegSample::moving_point).to(device), radius) +
       correlationLoss(match.correlation, offset.to(device), moving, radius));
  loss.matching = total.item<double>();

  // Flow, relative to the static flow that the network was given.
  std::vector<Eigen::Vector2f> residual(truth.flow.size());
  for (std::size_t i = 0; i < residual.size(); ++i)
  {
    residual[i] = truth.flow[i] - guide.second.flowAt(cells.quarter_place[i]);
  }
  const auto residual_truth = rowsOf(residual).to(device);
  // What moves out of the windows cannot be followed.
  const float farthest = (static_cast<float>(radius) + 0.5F) * 4 * current.cell_size;
  const auto known = residual_truth.isfinite().all(1) & residual_truth.abs().le(farthest).all(1);
  const auto known_index = known.nonzero().squeeze(1);
  if (known_index.numel() > 0)
  {
    auto flow_loss = torch::zeros({}, total.options());
    double weight = 1;
    for (auto r = out.residual.rbegin(); r != out.residual.rend(); ++r, weight *= options.decay)
    {
      const auto error =
          (r->index_select(0, known_index) - residual_truth.index_select(0, known_index))
              .square()
              .sum(1)
              .add(1e-4)
              .sqrt();
      flow_loss = flow_loss + weight * balancedMean(error, moving.index_select(0, known_index));
    }
    loss.flow = flow_loss.item<double>();
    total = total + flow_weight * flow_loss;
  }

  // Cells.
  const auto judged = flagsOf(truth.label, DysegSample::ignored_point)
                          .logical_not()
                          .to(device)
                          .nonzero()
                          .squeeze(1);
  const auto cell_label = moving.index_select(0, judged);
  const auto cell_error = nnf::binary_cross_entropy_with_logits(
      out.logit.index_select(0, judged), cell_label.to(torch::kFloat32),
      nnf::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone));
  // What looks as if it stayed, by the scan alone.
  const auto anchor_loss = balancedMean(
      nnf::binary_cross_entropy_with_logits(
          a.anchor.index_select(0, judged), cell_label.logical_not().to(torch::kFloat32),
          nnf::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone)),
      cell_label);
  loss.anchor = anchor_loss.item<double>();
  total = total + anchor_weight * anchor_loss;
  const auto cell_loss = 0.5 * balancedMean(cell_error, cell_label) + cell_error.mean();
  loss.cell = cell_loss.item<double>();
  total = total + cell_loss;

  // Points.
  const auto logits = out.logit.detach().cpu().contiguous();
  const std::vector<float> cell_logit(logits.data_ptr<float>(),
                                      logits.data_ptr<float>() + logits.numel());
  const auto drawn = drawPoints(sample, current, cell_logit, cells, options.points, draws);
  const auto& which = drawn.which;
  if (!which.empty())
  {
    std::vector<std::uint8_t> label;
    std::vector<Eigen::Vector2f> point_residual;
    for (const auto w : which)
    {
      const auto i = static_cast<std::size_t>(w);
      label.push_back(sample.label[current.source[i]]);
      const Eigen::Vector2f at = current.points[i].head<2>();
      point_residual.emplace_back(sample.flow[current.source[i]] - guide.second.flowAt(at));
    }
    const auto answer = net->points(current, a, b, past.rays, out, which);
    const auto truth_flag = flagsOf(label, DysegSample::moving_point).to(device);
    // Half as drawn, half as often as they are: sure of movers, yet few false alarms.
    const auto often = torch::tensor(drawn.weight).to(device);
    const auto point_error = nnf::binary_cross_entropy_with_logits(
        answer, truth_flag.to(torch::kFloat32),
        nnf::BinaryCrossEntropyWithLogitsFuncOptions().reduction(torch::kNone));
    auto point_loss = 0.5 * point_error.mean() + 2.0 * torch::dot(point_error, often) / often.sum();
    if (truth_flag.any().item<bool>())
    {
      point_loss = point_loss + lovaszLoss(answer, truth_flag, often);
    }
    loss.point = point_loss.item<double>();
    total = total + point_loss;

    const auto fine = rowsOf(point_residual).to(device);
    const auto fine_known = fine.isfinite().all(1).nonzero().squeeze(1);
    if (fine_known.numel() > 0)
    {
      const auto error = (net->pointFlow(current, a, out, which) - fine)
                             .index_select(0, fine_known)
                             .square()
                             .sum(1)
                             .add(1e-4)
                             .sqrt();
      total =
          total + upsampled_weight * balancedMean(error, truth_flag.index_select(0, fine_known));
    }
  }
  loss.total = total;
  return loss;
}
}  // namespace dyslam
