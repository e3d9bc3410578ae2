// SPDX-License-Identifier: BSD-3-Clause
#include "FactorGraphProblem.h"

#include <ceres/ceres.h>

#include <algorithm>

#include "CeresOptions.h"
#include "RobustLosses.h"

namespace dyslam
{
namespace
{
constexpr int steps_per_width = 10;  // of the robust loss, while it is narrowed

/** Cost function of Ceres: the whitened residual of a factor on value blocks. */
class FactorCost final : public ceres::CostFunction
{
 public:
  explicit FactorCost(const Factor& factor) : factor_(factor)
  {
    set_num_residuals(factor.type().dimension);
    for (const Key& key : factor.keys())
    {
      mutable_parameter_block_sizes()->push_back(key.isPose() ? pose_block_size
                                                              : velocity_block_size);
    }
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override
  {
    if (num_residuals() < 6)
    {
      evaluateSmall(blocks, residuals, jacobians);
      return true;
    }
    FactorJacobians derivatives;
    Eigen::Map<Vector6>(residuals).noalias() =
        factor_.whitening() *
        factor_.residual(blocks, jacobians != nullptr ? &derivatives : nullptr);
    for (std::size_t i = 0; jacobians != nullptr && i < factor_.keys().size(); ++i)
    {
      if (jacobians[i] == nullptr)
      {
        continue;
      }
      if (factor_.keys()[i].isPose())
      {
        Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> block(jacobians[i]);
        block.leftCols<6>().noalias() = factor_.whitening() * derivatives[i];
        block.col(6).setZero();
      }
      else
      {
        Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(jacobians[i]).noalias() =
            factor_.whitening() * derivatives[i];
      }
    }
    return true;
  }

 private:
  /** The same for less than six residuals. */
  void evaluateSmall(double const* const* blocks, double* residuals, double** jacobians) const
  {
    FactorJacobians derivatives;
    const int size = num_residuals();
    const Vector6 whitened =
        factor_.whitening() *
        factor_.residual(blocks, jacobians != nullptr ? &derivatives : nullptr);
    std::copy_n(whitened.data(), size, residuals);
    for (std::size_t i = 0; jacobians != nullptr && i < factor_.keys().size(); ++i)
    {
      if (jacobians[i] == nullptr)
      {
        continue;
      }
      const int columns = parameter_block_sizes()[i];
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> block(
          jacobians[i], size, columns);
      block.setZero();
      block.leftCols<6>() = Matrix6(factor_.whitening() * derivatives[i]).topRows(size);
    }
  }

  const Factor& factor_;
};

ceres::Problem::Options problemOptions()
{
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}
}  // namespace

FactorGraphProblem::FactorGraphProblem(const FactorGraphOptions& options,
                                       const std::vector<Key>& free,
                                       std::map<Key, FactorGraph::Variable>& variables,
                                       const std::vector<std::unique_ptr<const Factor>>& factors,
                                       const std::set<FactorGraph::FactorId>& left_out)
    : options_(options), loop_loss_(nullptr, ceres::TAKE_OWNERSHIP), problem_(problemOptions())
{
  std::vector<FactorGraph::FactorId> touching;
  for (const Key& key : free)
  {
    FactorGraph::Variable& variable = variables.at(key);
    problem_.AddParameterBlock(variable.block.data(),
                               key.isPose() ? pose_block_size : velocity_block_size,
                               key.isPose() ? &manifold_ : nullptr);
    touching.insert(touching.end(), variable.factors.begin(), variable.factors.end());
  }
  std::sort(touching.begin(), touching.end());
  touching.erase(std::unique(touching.begin(), touching.end()), touching.end());
  for (const FactorGraph::FactorId id : touching)
  {
    if (left_out.count(id) == 0)
    {
      add(*factors[id], variables);
    }
  }
  // Variables of the factors that are not free are constant.
  for (const Block& block : blocks_)
  {
    for (std::size_t i = 0; i < block.factor->keys().size(); ++i)
    {
      if (!std::binary_search(free.begin(), free.end(), block.factor->keys()[i]))
      {
        problem_.SetParameterBlockConstant(block.values[i]);
      }
    }
  }
}

void FactorGraphProblem::add(const Factor& factor, std::map<Key, FactorGraph::Variable>& variables)
{
  Block block{&factor, factor.loss(options_), {}};
  std::vector<double*> values;
  for (std::size_t i = 0; i < factor.keys().size(); ++i)
  {
    block.values[i] = variables.at(factor.keys()[i]).block.data();
    values.push_back(block.values[i]);
  }
  problem_.AddResidualBlock(new FactorCost(factor), lossOf(block), values);
  blocks_.push_back(block);
}

ceres::LossFunction* FactorGraphProblem::lossOf(const Block& block)
{
  if (block.loss.loss == RobustLoss::none)
  {
    return nullptr;
  }
  if (block.loss.is_place)
  {
    has_places_ = true;
    return &loop_loss_;
  }
  std::unique_ptr<ceres::LossFunction>& loss = losses_[{block.loss.loss, block.loss.width}];
  if (loss == nullptr)
  {
    loss = makeLoss(block.loss.loss, block.loss.width);
  }
  return loss.get();
}

ceres::Solver::Summary FactorGraphProblem::solve(double loop_loss_width,
                                                 int max_iterations,
                                                 double tolerance)
{
  loop_loss_.Reset(makeLoss(options_.loop_loss, loop_loss_width).release(), ceres::TAKE_OWNERSHIP);
  constexpr int threads = 1;  // for a reproducible result
  ceres::Solver::Summary summary;
  ceres::Solve(sparseSolverOptions(max_iterations, tolerance, threads), &problem_, &summary);
  return summary;
}

double FactorGraphProblem::chi2() const
{
  double sum = 0;
  for (const Block& block : blocks_)
  {
    sum += block.factor->whitenedResidual(block.values.data()).squaredNorm();
  }
  return sum;
}

/** Without localisations where there are too few steps to narrow the loss, as in a window of the
 * newest keyframes: a localisation that does not fit, which is never left out, would distort it. */
double FactorGraphProblem::worstPlace() const
{
  const bool with_localisations = options_.max_iterations > steps_per_width;
  double worst = 0;
  for (const Block& block : blocks_)
  {
    const bool can_be_left_out = block.factor->type().left_out_line != nullptr;
    if (block.loss.is_place && (can_be_left_out || with_localisations))
    {
      worst = std::max(worst, block.factor->whitenedResidual(block.values.data()).norm());
    }
  }
  return worst;
}

/** Narrows the loss from the largest residual to its final width (graduated non-convexity), so that
 * loops and localisations that do not fit only because of drift are not rejected at the start. */
int FactorGraphProblem::narrowLoopLoss()
{
  constexpr double narrowing = 3;
  int steps = 0;
  double width = 2 * worstPlace();
  while (width > options_.loop_loss_width && steps < options_.max_iterations)
  {
    steps +=
        stepsOf(solve(width, std::min(steps_per_width, options_.max_iterations - steps), 1e-3));
    width = std::min(width / narrowing, worstPlace());
  }
  return steps;
}

OptimisationResult FactorGraphProblem::solve()
{
  OptimisationResult result;
  result.initial_chi2 = chi2();
  if (has_places_)
  {
    result.iterations = narrowLoopLoss();
  }
  const ceres::Solver::Summary summary =
      solve(options_.loop_loss_width, std::max(0, options_.max_iterations - result.iterations),
            options_.tolerance);
  result.iterations += stepsOf(summary);
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.reason = summary.message;
  result.final_chi2 = chi2();
  return result;
}
}  // namespace dyslam
