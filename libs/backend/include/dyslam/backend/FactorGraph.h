// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>
#include <dyslam/backend/FactorGraphOptions.h>
#include <dyslam/backend/FactorType.h>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Result of an optimisation. */
struct OptimisationResult
{
  /** Sum of squared whitened residuals before the optimisation, without robust loss: of all
   * factors, as FactorGraph::chi2(), or of those of the given variables that are not left out. */
  double initial_chi2 = 0;
  double final_chi2 = 0;  //!< the same at the end
  int iterations = 0;
  std::size_t false_loops = 0;  //!< number of loops left out because they contradict the rest
  bool converged = false;
  std::string reason;                 //!< why the solver stopped
  std::vector<std::string> warnings;  //!< about the graph, for example unconstrained parts
};

/** The working graph of the backend (paper, Fig. 6 and Eq. 11): typed variables, factors of
 * explicit types, and their solution by Ceres.
 *
 * Always solved in one thread: the same graph gives the same bytes. Not thread-safe.
 */
class FactorGraph
{
 public:
  using FactorId = std::size_t;
  struct Variable
  {
    std::array<double, pose_block_size> block{};  //!< see ValueBlocks
    bool fixed = false;
    std::vector<FactorId> factors;  //!< factors with this variable
  };

  FactorGraph() = default;
  /** A graph with further types of factor. */
  explicit FactorGraph(FactorTypes types) : types_(std::move(types)) {}
  /** The types of factor that the graph can have. */
  [[nodiscard]] const FactorTypes& types() const { return types_; }

  /** Adds a variable. \throws std::invalid_argument if the key is taken, of the other type, or the
   * value is not finite. */
  void addPose(const Key& key, const Pose& pose);
  void addVector(const Key& key, const Vector6& vector);
  /** The same with the value as variables() has it. */
  void addBlock(const Key& key, const std::array<double, pose_block_size>& block);
  /** Removes a variable and all factors that have it. */
  void remove(const Key& key);

  [[nodiscard]] bool contains(const Key& key) const { return variables_.count(key) != 0; }
  /** \throws std::out_of_range, as the functions below, for a key that the graph does not have. */
  [[nodiscard]] Pose pose(const Key& key) const;
  [[nodiscard]] Vector6 vector(const Key& key) const;
  /** Sets a value. \throws std::invalid_argument for another type or a value that isn't finite. */
  void setPose(const Key& key, const Pose& pose);
  /** The same with the value as variables() has it. */
  void setBlock(const Key& key, const std::array<double, pose_block_size>& block);
  /** A fixed variable keeps its value in every optimisation. */
  void setFixed(const Key& key, bool fixed);
  /** All variables, ordered by key. */
  [[nodiscard]] const std::map<Key, Variable>& variables() const { return variables_; }

  /** Adds a factor. \throws std::invalid_argument if one of its variables is missing or its type is
   * not in types(). */
  FactorId add(std::unique_ptr<const Factor> factor);
  void removeFactor(FactorId id);
  [[nodiscard]] const Factor& factor(FactorId id) const;
  [[nodiscard]] const std::vector<FactorId>& factorsOf(const Key& key) const;
  /** All factors, in order of their ids. */
  [[nodiscard]] std::vector<FactorId> factorIds() const;
  [[nodiscard]] std::size_t factorCount() const { return factor_count_; }

  /** Length of the whitened residual at the present values. */
  [[nodiscard]] double whitenedResidual(FactorId id) const;
  /** Sum of squared whitened residuals at the present values, without robust loss. */
  [[nodiscard]] double chi2() const;

  /** Optimises all variables that are not fixed. In parts of the graph without a fixed variable the
   * first pose is kept fixed, with a warning.
   *
   * Unless `loop_loss` is none, it also decides which loops contradict the rest of the graph: these
   * are left out until the next optimisation of all variables. */
  OptimisationResult optimise(const FactorGraphOptions& options);
  /** Optimises only the given variables; all others are fixed, and no loops are newly left out. */
  OptimisationResult optimise(const FactorGraphOptions& options, const std::set<Key>& free);

  /** The data of the graph that an optimisation changes. */
  struct Solution
  {
    std::map<Key, std::array<double, pose_block_size>> blocks;
    std::set<FactorId> left_out;
  };
  [[nodiscard]] Solution solution() const;
  /** Restores a solution. \pre the graph has the variables and loops of the solution */
  void restore(const Solution& solution);

  /** Whether a loop is left out of optimisations. */
  [[nodiscard]] bool isLeftOut(FactorId id) const { return left_out_.count(id) != 0; }
  /** Leaves a loop out of optimisations until the next one of all variables decides again.
   * \throws std::invalid_argument for a factor that cannot be left out. */
  void leaveOut(FactorId loop);
  /** Loops that are not left out, in order of their ids. */
  [[nodiscard]] std::vector<FactorId> usedLoops() const;
  /** Loops that are left out. */
  [[nodiscard]] const std::set<FactorId>& leftOutLoops() const { return left_out_; }

  /** Marginal covariances of the variables `keys` at the present values, without robust loss, over
   * tangents (poses) or components (velocities); conditioned on the fixed variables and, unless
   * `free` is empty, on all variables that are not in `free`. What no factor measures (yaw and
   * translation of the vertical, the last three numbers of the accelerometer's bias) has zeros.
   * \throws std::runtime_error if the factors do not constrain a direction. */
  [[nodiscard]] std::vector<Matrix6> covariances(const std::vector<Key>& keys,
                                                 const std::set<Key>& free = {});

  /** Saves or loads variables, factors and their ids. */
  void exchangeState(StateArchive& archive);

 private:
  void requireNew(const Key& key) const;
  [[nodiscard]] Variable& variable(const Key& key);
  [[nodiscard]] const Variable& variable(const Key& key) const;

  FactorTypes types_;
  std::map<Key, Variable> variables_;
  std::vector<std::unique_ptr<const Factor>> factors_;  //!< by id; null: removed
  std::vector<FactorId> unused_;                        //!< ids of removed factors
  std::size_t factor_count_ = 0;
  std::set<FactorId> left_out_;  //!< ids of the loops that are left out
};
}  // namespace dyslam
