// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/DysegLosses.h>
#include <torch/torch.h>

#include <limits>

namespace dyslam
{
using torch::Tensor;

namespace
{
const Eigen::Vector2f unknown_flow =
    Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
constexpr int moving_points_needed = 3;
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
}  // namespace dyslam
