// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/train/DyloLoss.h>

#include <algorithm>
#include <array>

namespace dyslam
{
namespace
{
constexpr std::int64_t most_stages = 16;
constexpr std::array<double, 4> level_weight = {1.6, 0.8, 0.4, 0.2};

torch::Tensor maskedMean(const torch::Tensor& x, const torch::Tensor& mask)
{
  return (x * mask).sum() / mask.sum().clamp_min(1);
}

// Floors of the errors of the final pose: translation [m] and half of the rotation angle [rad].
constexpr double least_t = 0.005;
constexpr double least_q = 0.0002;

/** Huber loss: quadratic below 1, linear beyond. */
torch::Tensor huber(const torch::Tensor& x)
{
  const torch::Tensor size = x.abs();
  return torch::where(size.lt(1), 0.5 * size * size, size - 0.5);
}
}  // namespace

void DyloLossOptions::describe(OptionsVisitor& visitor)
{
  visitor.real("flow", flow, 0, 100, "weight of the loss on the error of the soft correspondences");
  visitor.real("precision", precision, 0, 100,
               "weight of the loss on the negative log-likelihood of the residuals");
  visitor.real("moving", moving, 0, 100,
               "weight of the loss on the cross-entropy of moving labels");
  visitor.real("final_pose", final_pose, 0, 100,
               "weight of the loss on the log error of the pose of the last, dense pass");
}

DyloLossImpl::DyloLossImpl(const DyloLossOptions& options) : options_(options)
{
  s_x_ = register_parameter("s_x", torch::zeros({most_stages}));
  s_q_ = register_parameter("s_q", torch::full({most_stages}, -2.5));
}

DyloLossImpl::Terms DyloLossImpl::forward(const std::vector<DyloStage>& stages,
                                          const ScanTensors& scan1,
                                          const PoseTensors& truth,
                                          const std::vector<torch::Tensor>& labels)
{
  const torch::Tensor zero = torch::zeros({}, s_x_.options());
  Terms terms{zero, zero, zero, zero, zero, zero, {}};
  for (std::size_t i = 0; i < stages.size(); ++i)
  {
    const DyloStage& stage = stages[i];
    const auto slot = static_cast<std::int64_t>(i);
    const double weight = level_weight[std::min<std::size_t>(i, level_weight.size() - 1)];
    const torch::Tensor t_error =
        ((stage.pose.translation - truth.translation).square().sum() + 1e-8).sqrt();
    // ||R - R*|| / (2 sqrt 2) = sin(angle / 2), to first order ||q - q*||, without q's sign.
    const torch::Tensor q_error =
        ((stage.pose.rotation - truth.rotation).square().sum() / 8 + 1e-10).sqrt();
    terms.translation_error.push_back(t_error.item<double>());
    if (stage.dense)
    {
      terms.final_pose = torch::log(t_error + least_t) + torch::log(q_error + least_q);
      continue;
    }
    terms.pose = terms.pose + weight * (t_error * torch::exp(-s_x_[slot]) + s_x_[slot] +
                                        q_error * torch::exp(-s_q_[slot]) + s_q_[slot]);

    const ScanTensors::Level& nodes = scan1.levels[stage.level];
    const torch::Tensor at_truth = truth.apply(nodes.xyz);
    const torch::Tensor label = labels[stage.level];
    const torch::Tensor not_moving = stage.valid * label.ne(2).to(torch::kFloat);
    const bool fine = i >= level_weight.size();
    if (!fine)
    {
      const torch::Tensor unit = 0.3 + 0.02 * nodes.xyz.norm(2, 1);
      const torch::Tensor miss = (stage.target - at_truth).norm(2, 1) / unit;
      terms.flow = terms.flow + weight * maskedMean(huber(miss), not_moving);
    }
    // Residuals at the true pose, as the mask's noise model sees them.
    const torch::Tensor residual = ((stage.normal * at_truth).sum(1) - stage.offset) / stage.noise;
    const torch::Tensor log_share =
        torch::log_sigmoid(stage.logits.is_static) + torch::log_sigmoid(stage.logits.quality);
    const torch::Tensor squared = 2 * huber(residual * torch::exp(0.5 * log_share));
    terms.precision =
        terms.precision +
        weight * maskedMean(0.5 * squared - 0.5 * log_share + torch::log(stage.noise), stage.valid);

    const torch::Tensor moving = label.eq(2).to(torch::kFloat);
    const torch::Tensor known =
        3 * moving + 0.5 * label.eq(1).to(torch::kFloat) + 0.05 * label.eq(0).to(torch::kFloat);
    const torch::Tensor entropy = -moving * torch::log_sigmoid(-stage.logits.is_static) -
                                  (1 - moving) * torch::log_sigmoid(stage.logits.is_static);
    terms.moving = terms.moving + weight * maskedMean(entropy * known, stage.valid);
  }
  terms.total = terms.pose + options_.flow * terms.flow + options_.precision * terms.precision +
                options_.moving * terms.moving + options_.final_pose * terms.final_pose;
  return terms;
}
}  // namespace dyslam
