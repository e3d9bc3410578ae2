// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/Factor.h>
#include <dyslam/core/Options.h>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace dyslam
{
class StateArchive;

/** Robust loss, of the squared whitened residual. */
enum class RobustLoss
{
  none,
  cauchy,  //!< logarithmic beyond the width
  dcs,     //!< dynamic covariance scaling: a switchable constraint with the switch solved for
};

struct FactorGraphOptions : Options
{
  int max_iterations = 50;
  double tolerance = 1e-6;  //!< stop when a step lowers the cost by less than this fraction
  RobustLoss loop_loss = RobustLoss::dcs;  //!< robust loss of loop factors
  double loop_loss_width = 3;              //!< width of loop_loss, as a whitened residual
  /** Factor on the odometry's sigmas when loops are checked against it. */
  double odometry_sigma_scale = 3;
  RobustLoss object_loss = RobustLoss::cauchy;  //!< robust loss of observation factors
  double object_loss_width = 3;                 //!< width of object_loss, as a whitened residual
  RobustLoss gnss_loss = RobustLoss::cauchy;    //!< robust loss of positions of the receiver
  double gnss_loss_width = 2;                   //!< width of gnss_loss, as a whitened residual

  void describe(OptionsVisitor& visitor) override;
};

/** How an optimisation went. */
struct OptimisationResult
{
  double initial_chi2 = 0;  //!< sum of squared whitened residuals, without robust loss
  double final_chi2 = 0;    //!< the same at the end
  int iterations = 0;
  std::size_t false_loops = 0;  //!< left out because they contradict the rest
  bool converged = false;
  std::string reason;                 //!< why it stopped
  std::vector<std::string> warnings;  //!< of the graph, for example about unconstrained parts
};

/** The working graph of the backend (paper, Fig. 6 and Eq. 11): typed variables, factors of
 * explicit kinds, and their solution by Ceres.
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
    std::vector<FactorId> factors;  //!< that touch it
  };

  /** Adds a variable. \throws std::invalid_argument if the key is taken, of the other type, or the
   * value is not finite. */
  void addPose(const Key& key, const Pose& pose);
  void addVelocity(const Key& key, const Vector6& twist);
  /** The same with the value as variables() has it. */
  void addBlock(const Key& key, const std::array<double, pose_block_size>& block);
  /** Removes it with all factors that touch it. */
  void remove(const Key& key);

  [[nodiscard]] bool contains(const Key& key) const { return variables_.count(key) != 0; }
  /** \throws std::out_of_range, here and below, for a key that the graph does not have. */
  [[nodiscard]] Pose pose(const Key& key) const;
  [[nodiscard]] Vector6 velocity(const Key& key) const;
  /** \throws std::invalid_argument also for a value of the other type or one that is not finite. */
  void setPose(const Key& key, const Pose& pose);
  /** The same with the value as variables() has it. */
  void setBlock(const Key& key, const std::array<double, pose_block_size>& block);
  /** A fixed variable keeps its value in every optimisation. */
  void setFixed(const Key& key, bool fixed);
  /** In order of keys. */
  [[nodiscard]] const std::map<Key, Variable>& variables() const { return variables_; }

  /** \throws std::invalid_argument if one of its variables is missing. */
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

  /** Optimises all variables that are not fixed. Parts of the graph without a fixed variable keep
   * their first pose where it is, and a warning says so.
   *
   * Unless the loss of loops is none, it also decides which loops contradict the rest of the graph:
   * these are left out until the next such call. */
  OptimisationResult optimise(const FactorGraphOptions& options);
  /** Optimises the given variables alone; all others keep their values, and no loop is decided. */
  OptimisationResult optimise(const FactorGraphOptions& options, const std::set<Key>& free);

  /** What an optimisation changes. */
  struct Solution
  {
    std::map<Key, std::array<double, pose_block_size>> blocks;
    std::set<FactorId> left_out;
  };
  [[nodiscard]] Solution solution() const;
  /** \pre the graph has the variables and loops of the solution */
  void restore(const Solution& solution);

  /** Whether the last optimisation of all variables left this loop out. */
  [[nodiscard]] bool isLeftOut(FactorId id) const { return left_out_.count(id) != 0; }
  /** Leaves a loop out, until the next optimisation of all variables decides again.
   * \throws std::invalid_argument for a factor of another kind. */
  void leaveOut(FactorId loop);
  /** Loops that are not left out, in order of their ids. */
  [[nodiscard]] std::vector<FactorId> usedLoops() const;
  [[nodiscard]] std::size_t leftOutLoops() const { return left_out_.size(); }

  /** Marginal covariances over the tangents (poses) or components (velocities) of some variables at
   * the present values, without robust loss; given the fixed variables, and where `free` is not
   * empty given all variables that it does not name.
   * \throws std::runtime_error where the factors do not constrain a direction. */
  [[nodiscard]] std::vector<Matrix6> covariances(const std::vector<Key>& keys,
                                                 const std::set<Key>& free = {});

  /** Variables, factors and their ids. */
  void exchangeState(StateArchive& archive);

 private:
  void requireNew(const Key& key) const;
  [[nodiscard]] Variable& variable(const Key& key);
  [[nodiscard]] const Variable& variable(const Key& key) const;
  [[nodiscard]] OptimisationResult optimiseVariables(const FactorGraphOptions& options,
                                                     const std::vector<Key>& free);
  /** Solves without the groups of loops that the rest contradicts, the worst first, and at last
   * without the loops that do not fit. */
  void leaveOutContradicted(const FactorGraphOptions& options,
                            const std::vector<Key>& free,
                            OptimisationResult& result);
  /** The same; where more groups of loops were left out than kept, also tries the solution without
   * those that were kept, and takes it if it keeps more groups.
   * \param start values before the first optimisation */
  void leaveOutFalseLoops(const FactorGraphOptions& options,
                          const std::vector<Key>& free,
                          const std::map<Key, Variable>& start,
                          OptimisationResult& result);
  /** Takes the first pose of every part of `free` that no other variable holds out of it. */
  void fixUnconstrainedParts(std::vector<Key>& free, std::vector<std::string>& warnings) const;

  std::map<Key, Variable> variables_;
  std::vector<std::unique_ptr<const Factor>> factors_;  //!< null where one was removed
  std::vector<FactorId> unused_;                        //!< of those
  std::size_t factor_count_ = 0;
  std::set<FactorId> left_out_;  //!< loops
};
}  // namespace dyslam
