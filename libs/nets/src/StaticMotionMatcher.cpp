// SPDX-License-Identifier: BSD-3-Clause
#include "StaticMotionMatcher.h"

#include <dyslam/nets/MotionSearch.h>
#include <torch/torch.h>

#include <algorithm>

namespace dyslam
{
using torch::Tensor;

namespace
{
constexpr float voting_half_extent = 51.2F;  // half side of the square of voting cells [m]
constexpr float min_static_weight = 0.01F;   // least weight of a cell in the refinement
constexpr double fine_width = 0.15;          // final width of the robust loss [m]
// Yaw grids of the motion search: step [rad] and number of steps to each side.
constexpr double coarse_yaw_step = 0.035;
constexpr int coarse_yaw_steps = 3;
constexpr double fine_yaw_step = 0.012;
constexpr int fine_yaw_steps = 2;
constexpr int max_refinements = 8;          // largest number of iterations of the fine fit
constexpr double convergence_step = 0.003;  // step below which the fine fit has converged [m]
constexpr double max_contraction = 0.85;    // upper limit of the ratio of successive steps
constexpr double lever = 20;                // lever arm of rotations in the size of a step [m]

/** 1 for cells that vote for the static motion, else 0. Distant cells are excluded: they contain
 * few points each. */
Tensor votingMask(const std::vector<Eigen::Vector2f>& positions)
{
  auto mask = torch::empty({static_cast<std::int64_t>(positions.size())});
  std::transform(positions.begin(), positions.end(), mask.data_ptr<float>(),
                 [](const Eigen::Vector2f& p)
                 { return p.cwiseAbs().maxCoeff() < voting_half_extent ? 1.0F : 0.0F; });
  return mask;
}

/** Maximum-likelihood static motion from a correlation. */
MotionSearchResult searchCorrelation(const Tensor& correlation,
                                     const Tensor& static_weight,
                                     int radius,
                                     float cell_size,
                                     const std::vector<Eigen::Vector2f>& positions,
                                     const PlanarMotion& centre,
                                     double yaw_step,
                                     int yaw_steps)
{
  torch::NoGradGuard no_gradient;
  const auto probability = correlation.softmax(1).cpu().contiguous();
  const auto weights = static_weight.cpu().contiguous();
  const std::vector<float> weight(weights.data_ptr<float>(),
                                  weights.data_ptr<float>() + weights.numel());
  return searchMotion({probability.data_ptr<float>(), radius, cell_size, positions, weight}, centre,
                      yaw_step, yaw_steps);
}
}  // namespace

Tensor rigidFlow(const PlanarMotion& motion, const std::vector<Eigen::Vector2f>& positions)
{
  auto flow = torch::empty({static_cast<std::int64_t>(positions.size()), 2});
  auto* out = flow.data_ptr<float>();
  const Eigen::Matrix2f R = Eigen::Rotation2Dd(motion.yaw).toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = motion.translation.cast<float>();
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const Eigen::Vector2f f = R * positions[i] + t - positions[i];
    out[2 * i] = f.x();
    out[2 * i + 1] = f.y();
  }
  return flow;
}

StaticMotionMatcher::StaticMotionMatcher(const BevScan& scan,
                                         const DysegEncoding& current,
                                         const SparseMap& past,
                                         int radius)
    : current_(current),
      cells_(*current.cells),
      past_(past),
      radius_(radius),
      cell_size_(4 * scan.cell_size),
      static_weight_(current.static_logit.detach().sigmoid().square() *
                     votingMask(cells_.quarter_centre).to(current.middle.device()))
{
}

Tensor StaticMotionMatcher::correlationAround(const PlanarMotion& motion) const
{
  const auto flow = rigidFlow(motion, cells_.quarter_centre).to(current_.middle.device());
  return correlate(current_.middle, past_, cells_.quarter_position + flow / cell_size_, radius_);
}

PlanarMotion StaticMotionMatcher::search(const Tensor& coarse_correlation, double& margin) const
{
  const auto coarse_weight =
      gatherRows(static_weight_.unsqueeze(1), cells_.eighth_children).mean(1);
  const MotionSearchResult coarse =
      searchCorrelation(coarse_correlation, coarse_weight, radius_, 2 * cell_size_,
                        cells_.eighth_centre, PlanarMotion(), coarse_yaw_step, coarse_yaw_steps);
  margin = coarse.margin;
  return searchCorrelation(correlationAround(coarse.motion), static_weight_, radius_, cell_size_,
                           cells_.quarter_centre, coarse.motion, fine_yaw_step, fine_yaw_steps)
      .motion;
}

StaticMotionMatcher::Voters StaticMotionMatcher::voters() const
{
  torch::NoGradGuard no_gradient;
  const auto weights = static_weight_.cpu().contiguous();
  const float* w = weights.data_ptr<float>();
  Voters v;
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < cells_.quarter_centre.size(); ++i)
  {
    if (w[i] > min_static_weight)
    {
      rows.push_back(static_cast<std::int64_t>(i));
      v.centre.push_back(cells_.quarter_centre[i]);
      v.weight.push_back(w[i]);
    }
  }
  const auto index = torch::tensor(rows, torch::kLong).to(current_.middle.device());
  v.features = current_.middle.index_select(0, index);
  v.position = cells_.quarter_position.index_select(0, index);
  return v;
}

RigidFlowFit StaticMotionMatcher::fitPeaks(const Voters& voters,
                                           const PlanarMotion& centre,
                                           double start_width) const
{
  torch::NoGradGuard no_gradient;
  const auto base = rigidFlow(centre, voters.centre);
  const auto correlation =
      correlate(voters.features, past_,
                voters.position + base.to(current_.middle.device()) / cell_size_, radius_);
  const auto peak = peakOffset(correlation, radius_).cpu().contiguous();
  const float* p = peak.data_ptr<float>();
  const float* b = base.data_ptr<float>();
  std::vector<Eigen::Vector2f> flow(voters.centre.size());
  std::vector<float> weight(voters.centre.size());
  for (std::size_t i = 0; i < flow.size(); ++i)
  {
    flow[i] = cell_size_ * Eigen::Vector2f(p[3 * i], p[3 * i + 1]) +
              Eigen::Vector2f(b[2 * i], b[2 * i + 1]);
    weight[i] = p[3 * i + 2] * p[3 * i + 2] * voters.weight[i];
  }
  return fitRigidFlow(voters.centre, flow, weight, fine_width, start_width, &centre);
}

/** Peaks between cells are biased towards the window's centre: the fit is repeated with the windows
 * centred at the estimate. The error shrinks by a constant factor, which Aitken's delta-squared
 * method extrapolates. */
RigidFlowFit StaticMotionMatcher::refine(const PlanarMotion& initial, double start_width) const
{
  const Voters cells = voters();
  RigidFlowFit fit;
  fit.motion = initial;
  if (cells.centre.empty())
  {
    return fit;
  }
  PlanarMotion centre = initial;
  Eigen::Vector3d last_step = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < max_refinements; ++iteration)
  {
    fit = fitPeaks(cells, centre, start_width);
    if (!fit.converged)
    {
      break;
    }
    Eigen::Vector3d step;
    step << fit.motion.translation - centre.translation, lever * (fit.motion.yaw - centre.yaw);
    const double contraction =
        last_step.squaredNorm() > 0
            ? std::clamp(step.dot(last_step) / last_step.squaredNorm(), 0.0, max_contraction)
            : 0.0;
    last_step = iteration % 2 == 0 ? step : Eigen::Vector3d::Zero();
    step /= 1 - contraction;
    centre.translation += step.head<2>();
    centre.yaw += step.z() / lever;
    fit.motion = centre;
    if (step.norm() < convergence_step)
    {
      break;
    }
  }
  return fit;
}
}  // namespace dyslam
