// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/DyloMatcher.h>
#include <dyslam/nets/DyloModel.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t sampled_level = 1;

/** A residual that may come from noise and the sampling of surfaces [m]. */
double inlierDistance(double range)
{
  return 0.15 + 0.005 * range;
}

struct SampledNode
{
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  float confidence = 0;
  bool used = false;
};
}  // namespace

struct DyloMatcher::Impl
{
  DyloNetwork network{nullptr};
  int threads = 1;
  std::vector<Eigen::Vector3f> points;
  PreparedScan prepared;
  EncodedScan current, reference;
  bool has_reference = false;
  std::vector<SampledNode> nodes;  //!< of the last match

  void useThreads() const
  {
    if (torch::get_num_threads() != threads)
    {
      torch::set_num_threads(threads);
    }
  }
  void keepConfidence(const DyloStage& stage);
  [[nodiscard]] float confidenceNear(const Eigen::Vector3f& p, std::int32_t cell) const;
};

DyloMatcher::DyloMatcher(const std::string& weights, int threads) : impl_(std::make_unique<Impl>())
{
  impl_->network = loadDylo(weights);
  impl_->network->eval();
  impl_->threads = std::max(1, threads);
}

DyloMatcher::~DyloMatcher() = default;
DyloMatcher::DyloMatcher(DyloMatcher&&) noexcept = default;
DyloMatcher& DyloMatcher::operator=(DyloMatcher&&) noexcept = default;

std::size_t DyloMatcher::setCurrent(const std::vector<Eigen::Vector3f>& points)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  s.useThreads();
  s.points = points;
  s.prepared = prepareScan(points);
  s.nodes.clear();
  if (!s.prepared.empty())
  {
    s.current = s.network->encode(toTensors(s.prepared));
  }
  return s.prepared.valid_points;
}

void DyloMatcher::keepAsReference()
{
  impl_->reference = impl_->current;
  impl_->has_reference = !impl_->prepared.empty();
}

void DyloMatcher::forgetReference()
{
  impl_->has_reference = false;
}

DyloMatch DyloMatcher::match(const Pose& start)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  DyloMatch match;
  match.T_reference_current = start;
  if (!s.has_reference || s.prepared.empty())
  {
    return match;
  }
  s.useThreads();
  const std::vector<DyloStage> stages =
      s.network->forward(s.current, s.reference, PoseTensors::from(start, torch::kFloat));
  const DyloStage& last = stages.back();
  const Pose before = stages[stages.size() - 2].pose.toPose();
  match.T_reference_current = last.pose.toPose();
  const Vector6 step = logSE3(before.inverse() * match.T_reference_current);
  match.last_step = step.head<3>().norm() + 10 * step.tail<3>().norm();

  if (last.normal_matrix.defined())
  {
    const torch::Tensor normal = last.normal_matrix.to(torch::kDouble).contiguous();
    const Matrix6 left =
        Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(normal.data_ptr<double>());
    // The network's step stands on the left of the motion.
    const Matrix6 adjoint = adjointSE3(match.T_reference_current);
    match.normal_matrix = adjoint.transpose() * left * adjoint;
  }
  // How well the points lie on the surfaces matched, at the pose found.
  const torch::Tensor moved = last.pose.apply(s.current.scan.levels[last.level].xyz);
  const torch::Tensor residual = (last.normal * moved).sum(1) - last.offset;
  const torch::Tensor range = moved.norm(2, 1);
  const float* r = residual.data_ptr<float>();
  const float* w = last.weight.data_ptr<float>();
  const float* valid = last.valid.data_ptr<float>();
  match.sampled =
      static_cast<std::size_t>(s.current.scan.levels[last.level].valid.sum().item<double>() + 0.5);
  const float* distance = range.data_ptr<float>();
  double squares = 0;
  double weight_squares = 0;
  for (std::int64_t i = 0; i < residual.size(0); ++i)
  {
    if (valid[i] == 0)
    {
      continue;
    }
    const double error = static_cast<double>(r[i]);
    const double weight = static_cast<double>(w[i]);
    ++match.matched;
    match.inliers += std::abs(error) < inlierDistance(static_cast<double>(distance[i])) ? 1U : 0U;
    squares += weight * error * error;
    weight_squares += weight * weight;
  }
  match.rmse = std::sqrt(squares);
  match.effective_points = weight_squares > 0 ? 1 / weight_squares : 0;
  s.keepConfidence(last);
  return match;
}

void DyloMatcher::Impl::keepConfidence(const DyloStage& stage)
{
  nodes.clear();
  if (stage.level != sampled_level)
  {
    return;
  }
  const torch::Tensor confidence = torch::sigmoid(stage.logits.is_static).contiguous();
  const float* c = confidence.data_ptr<float>();
  const float* valid = stage.valid.data_ptr<float>();
  const PreparedScan::Level& level = prepared.levels[sampled_level];
  nodes.resize(level.size());
  for (std::size_t n = 0; n < level.size(); ++n)
  {
    if (level.cell[n] >= 0 && valid[n] > 0)
    {
      nodes[n] = {prepared.points[static_cast<std::size_t>(level.cell[n])], c[n], true};
    }
  }
}

float DyloMatcher::Impl::confidenceNear(const Eigen::Vector3f& p, std::int32_t cell) const
{
  const PreparedScan::Level& level = prepared.levels[sampled_level];
  const int row = cell / PreparedScan::columns * level.rows / prepared.rows;
  const int col = cell % PreparedScan::columns * level.cols / PreparedScan::columns;
  const float reach = 0.5F + 0.05F * p.norm();
  float weight_sum = 0;
  float sum = 0;
  for (int i = std::max(0, row - 1); i <= std::min(level.rows - 1, row + 1); ++i)
  {
    for (int j = col - 1; j <= col + 1; ++j)
    {
      const int wrapped = (j + level.cols) % level.cols;
      const SampledNode& node = nodes[static_cast<std::size_t>(i * level.cols + wrapped)];
      const float d2 = (node.point - p).squaredNorm() / (reach * reach);
      if (node.used && d2 < 1)
      {
        const float weight = 1 / (0.002F + d2 * d2);
        weight_sum += weight;
        sum += weight * node.confidence;
      }
    }
  }
  return weight_sum > 0 ? sum / weight_sum : 1.F;
}

std::vector<float> DyloMatcher::staticConfidence() const
{
  const Impl& s = *impl_;
  std::vector<float> confidence(s.points.size(), 1.F);
  if (s.nodes.empty())
  {
    return confidence;
  }
  for (std::size_t i = 0; i < s.points.size(); ++i)
  {
    const std::int32_t cell = s.prepared.cell_of_point[i];
    if (cell >= 0)
    {
      confidence[i] = s.confidenceNear(s.points[i], cell);
    }
  }
  return confidence;
}
}  // namespace dyslam
