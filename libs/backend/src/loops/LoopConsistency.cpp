// SPDX-License-Identifier: BSD-3-Clause
#include "LoopConsistency.h"

#include <dyslam/backend/factors/LocalisationFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cstdlib>
#include <map>
#include <vector>

namespace dyslam
{
namespace
{
using FactorId = FactorGraph::FactorId;
using SparseMatrix = Eigen::SparseMatrix<double>;
using RowSparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/** Loops form a group if both of their ends are at most this number of keyframes apart. */
constexpr std::int64_t group_reach = 10;
constexpr std::size_t max_group_size = 8;
/** Information added to every ego pose: unconstrained parts of the graph stay in place. */
constexpr double anchor_information = 1e-6;

bool fits(const FactorGraph& graph, FactorId id, double loss_width)
{
  const double residual = graph.whitenedResidual(id);
  return residual * residual <= 2 * loss_width * loss_width;
}

/** Groups of neighbouring loops. */
std::vector<std::vector<FactorId>> grouped(const FactorGraph& graph, std::vector<FactorId> loops)
{
  const auto ends = [&graph](FactorId id)
  {
    const std::vector<Key>& keys = graph.factor(id).keys();
    return std::make_pair(keys[0].index, keys[1].index);
  };
  std::stable_sort(loops.begin(), loops.end(),
                   [&](FactorId a, FactorId b) { return ends(a) < ends(b); });
  std::vector<std::vector<FactorId>> groups;
  std::vector<std::size_t> open;  // groups that later loops may belong to, in order
  for (const FactorId id : loops)
  {
    const auto last = [&](std::size_t group) { return ends(groups[group].back()); };
    open.erase(std::remove_if(open.begin(), open.end(),
                              [&](std::size_t group)
                              {
                                return groups[group].size() == max_group_size ||
                                       ends(id).first - last(group).first > group_reach;
                              }),
               open.end());
    const auto group =
        std::find_if(open.begin(), open.end(),
                     [&](std::size_t candidate)
                     { return std::abs(last(candidate).second - ends(id).second) <= group_reach; });
    if (group == open.end())
    {
      open.push_back(groups.size());
      groups.push_back({id});
    }
    else
    {
      groups[*group].push_back(id);
    }
  }
  return groups;
}

using Factorisation = Eigen::SimplicialLDLT<SparseMatrix>;

/** Columns of L between the entries of some rows and the root of the elimination tree, sorted.
 * \param order column of L for each column of `jacobian` */
template <typename Order>
std::vector<Eigen::Index> reachedColumns(const SparseMatrix& L,
                                         const Order& order,
                                         const RowSparseMatrix& jacobian,
                                         const std::vector<Eigen::Index>& rows)
{
  std::set<Eigen::Index> visited;
  for (const Eigen::Index row : rows)
  {
    for (RowSparseMatrix::InnerIterator entry(jacobian, row); entry; ++entry)
    {
      Eigen::Index column = order[entry.col()];
      while (visited.insert(column).second)
      {
        const SparseMatrix::InnerIterator parent(L, column);
        if (!parent)
        {
          break;
        }
        column = parent.row();
      }
    }
  }
  return {visited.begin(), visited.end()};
}

/** J Sigma J^T, where J are some rows of `jacobian` and Sigma is the inverse of the matrix that was
 * factorised to L D L^T. Only the columns of L that these rows reach are visited. */
Eigen::MatrixXd selectedCovariance(const Factorisation& factored,
                                   const RowSparseMatrix& jacobian,
                                   const std::vector<Eigen::Index>& rows)
{
  const SparseMatrix& L = factored.matrixL().nestedExpression();
  const auto& order = factored.permutationP().indices();
  std::vector<Eigen::Index> visited = reachedColumns(L, order, jacobian, rows);
  const auto slot = [&visited](Eigen::Index column)
  { return std::lower_bound(visited.begin(), visited.end(), column) - visited.begin(); };

  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto count = static_cast<Eigen::Index>(rows.size());
  RowMatrix v = RowMatrix::Zero(static_cast<Eigen::Index>(visited.size()), count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    for (RowSparseMatrix::InnerIterator entry(jacobian, rows[static_cast<std::size_t>(i)]); entry;
         ++entry)
    {
      v(slot(order[entry.col()]), i) = entry.value();
    }
  }
  // Forward substitution, v <- L^-1 v: every row that is written to is visited, too.
  Eigen::VectorXd weights(v.rows());
  for (Eigen::Index k = 0; k < v.rows(); ++k)
  {
    const Eigen::Index column = visited[static_cast<std::size_t>(k)];
    weights[k] = 1 / factored.vectorD()[column];
    auto below = visited.begin() + k;
    for (SparseMatrix::InnerIterator entry(L, column); entry; ++entry)
    {
      below = std::lower_bound(below, visited.end(), entry.row());
      v.row(below - visited.begin()) -= entry.value() * v.row(k);
    }
  }
  return v.transpose() * weights.asDiagonal() * v;
}

/** Odometry and loops between the free ego poses, and their localisations in a prior map that fit,
 * linearised at the present values. */
class LinearEgoGraph
{
 public:
  LinearEgoGraph(const FactorGraph& graph,
                 const std::vector<FactorId>& loops,
                 double loss_width,
                 double odometry_sigma_scale)
      : graph_(graph)
  {
    for (const auto& [key, variable] : graph.variables())
    {
      const bool is_pose =
          key.kind == VariableKind::ego_pose || key.kind == VariableKind::prior_map;
      if (is_pose && !variable.fixed)
      {
        columns_.emplace(key, 6 * static_cast<Eigen::Index>(columns_.size()));
      }
    }
    for (const FactorId id : graph.factorIds())
    {
      if (graph.factor(id).is<OdometryFactor>())
      {
        addRows(id, 1 / odometry_sigma_scale);
      }
      else if (graph.factor(id).is<LocalisationFactor>() && fits(graph, id, loss_width))
      {
        addRows(id, 1);
        ++localisations_;
      }
    }
    for (const FactorId id : loops)
    {
      loop_rows_[id] = rows_;
      addRows(id, 1);
    }
    solve();
  }

  [[nodiscard]] bool solved() const { return solver_.info() == Eigen::Success; }
  [[nodiscard]] double chi2() const { return optimal_residuals_.squaredNorm(); }
  [[nodiscard]] std::size_t localisations() const { return localisations_; }

  /** Decrease of chi2 without these loops. */
  [[nodiscard]] double chi2Decrease(const std::vector<FactorId>& group) const
  {
    const auto size = 6 * static_cast<Eigen::Index>(group.size());
    std::vector<Eigen::Index> rows;
    Eigen::VectorXd r(size);
    for (const FactorId id : group)
    {
      const Eigen::Index first = loop_rows_.at(id);
      r.segment<6>(static_cast<Eigen::Index>(rows.size())) = optimal_residuals_.segment<6>(first);
      for (Eigen::Index row = first; row < first + 6; ++row)
      {
        rows.push_back(row);
      }
    }
    const Eigen::MatrixXd rest =
        Eigen::MatrixXd::Identity(size, size) - selectedCovariance(solver_, by_row_, rows);
    const Eigen::LDLT<Eigen::MatrixXd> factored(rest);
    // Loops that are the only constraint of a part of the graph are not contradicted.
    constexpr double least = 1e-9;
    return factored.vectorD().minCoeff() > least ? r.dot(factored.solve(r)) : 0;
  }

 private:
  void addRows(FactorId id, double weight)
  {
    const Factor& factor = graph_.factor(id);
    std::array<const double*, max_keys_per_factor> blocks{};
    for (std::size_t i = 0; i < factor.keys().size(); ++i)
    {
      blocks[i] = graph_.variables().at(factor.keys()[i]).block.data();
    }
    FactorJacobians jacobians;
    const Vector6 residual =
        weight * (factor.whitening() * factor.residual(blocks.data(), &jacobians));
    residuals_.insert(residuals_.end(), residual.data(), residual.data() + 6);
    for (std::size_t i = 0; i < factor.keys().size(); ++i)
    {
      const auto column = columns_.find(factor.keys()[i]);
      if (column == columns_.end())
      {
        continue;
      }
      const Matrix6 block = weight * (factor.whitening() * jacobians[i]);
      for (int r = 0; r < 6; ++r)
      {
        for (int c = 0; c < 6; ++c)
        {
          triplets_.emplace_back(rows_ + r, column->second + c, block(r, c));
        }
      }
    }
    rows_ += 6;
  }

  void solve()
  {
    const auto size = 6 * static_cast<Eigen::Index>(columns_.size());
    jacobian_.resize(rows_, size);
    jacobian_.setFromTriplets(triplets_.begin(), triplets_.end());
    triplets_ = {};
    by_row_ = jacobian_;
    SparseMatrix information = jacobian_.transpose() * jacobian_;
    for (Eigen::Index i = 0; i < size; ++i)
    {
      information.coeffRef(i, i) += anchor_information;
    }
    solver_.compute(information);
    const Eigen::Map<const Eigen::VectorXd> residuals(residuals_.data(), rows_);
    optimal_residuals_ = residuals;
    if (solved())
    {
      optimal_residuals_ -= jacobian_ * solver_.solve(jacobian_.transpose() * residuals);
    }
  }

  const FactorGraph& graph_;
  std::map<Key, Eigen::Index> columns_;
  std::map<FactorId, Eigen::Index> loop_rows_;
  std::size_t localisations_ = 0;  //!< number of those in the linear graph
  Eigen::Index rows_ = 0;
  std::vector<double> residuals_;
  Triplets triplets_;
  SparseMatrix jacobian_;
  RowSparseMatrix by_row_;
  Factorisation solver_;
  Eigen::VectorXd optimal_residuals_;
};
}  // namespace

std::set<FactorId> inconsistentLoops(const FactorGraph& graph, double loss_width)
{
  std::set<FactorId> result;
  for (const FactorId id : graph.usedLoops())
  {
    if (!fits(graph, id, loss_width))
    {
      result.insert(id);
    }
  }
  return result;
}

std::size_t independentGroups(const FactorGraph& graph, const std::set<FactorId>& loops)
{
  return grouped(graph, {loops.begin(), loops.end()}).size();
}

std::set<FactorId> contradictedLoops(const FactorGraph& graph,
                                     double loss_width,
                                     double odometry_sigma_scale)
{
  std::vector<FactorId> loops = graph.usedLoops();
  loops.erase(std::remove_if(loops.begin(), loops.end(),
                             [&](FactorId id) { return !fits(graph, id, loss_width); }),
              loops.end());
  if (loops.empty())
  {
    return {};
  }
  const LinearEgoGraph linear(graph, loops, loss_width, odometry_sigma_scale);
  std::set<FactorId> worst;
  double highest = 2 * loss_width * loss_width;
  for (const std::vector<FactorId>& group : grouped(graph, loops))
  {
    const std::size_t others = loops.size() - group.size() + linear.localisations();
    if (!linear.solved() || others == 0)
    {
      continue;  // odometry alone drifts and is no evidence
    }
    const double decrease = linear.chi2Decrease(group);
    // Agreement of odometry, the other loops and localisations: drift affects all of them.
    const double variance =
        std::max(1.0, (linear.chi2() - decrease) / (6 * static_cast<double>(others)));
    const double per_loop = decrease / static_cast<double>(group.size()) / variance;
    if (per_loop > highest)
    {
      highest = per_loop;
      worst = {group.begin(), group.end()};
    }
  }
  return worst;
}
}  // namespace dyslam
