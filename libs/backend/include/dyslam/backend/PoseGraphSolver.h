// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PoseGraph.h>
#include <dyslam/core/Options.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Parametrisation of an edge's error E = T_measured^-1 T_i^-1 T_j as a residual. Both agree to
 * first order, so they share one information matrix. */
enum class EdgeResidual
{
  log,  //!< log(E) in SE(3), the paper's
  g2o,  //!< translation of E and twice its quaternion's vector part; the heading in planar graphs
};

/** Initial values of the poses. */
enum class GraphStart
{
  file,     //!< the graph's own poses; nodes without one are initialised from their neighbours
  chordal,  //!< linear least squares on rotation matrices, then on translations
};

/** What to do about an edge whose information matrix is not positive definite. */
enum class IndefiniteInformation
{
  error,    //!< refuse the graph, naming the edge
  project,  //!< raise its eigenvalues to at least 1e-9 of the largest
};

struct PoseGraphSolverOptions : Options
{
  int max_iterations = 100;
  double tolerance = 1e-9;  //!< stop when a step lowers the cost by less than this fraction
  EdgeResidual residual = EdgeResidual::g2o;
  GraphStart start = GraphStart::chordal;
  IndefiniteInformation indefinite_information = IndefiniteInformation::error;
  int threads = 1;  //!< changes the result by rounding alone; with 1 it is always the same

  void describe(OptionsVisitor& visitor) override;
};

struct PoseGraphResult
{
  double start_chi2 = 0;    //!< of the poses the graph came with (of the start, if it had none)
  double initial_chi2 = 0;  //!< where the optimisation started
  double final_chi2 = 0;    //!< sum of e' Omega e over all edges
  int iterations = 0;
  std::size_t projected_edges = 0;  //!< whose information was not positive definite
  bool converged = false;
  std::string reason;  //!< why it stopped
};

/** Least-squares optimisation of a pose graph.
 *
 * With `residual = g2o` chi2 is what g2o prints. Graphs whose every pose, measurement and
 * information matrix is planar are solved in the plane.
 * Thread-safe: solve() is const.
 */
class PoseGraphSolver
{
 public:
  explicit PoseGraphSolver(const PoseGraphSolverOptions& options);

  /** Moves all nodes except the root, which stays where it is (at identity if it has no pose).
   * An empty graph and one without edges converge at once.
   * \throws UserError for a node without edges to the root's component, and for an edge whose
   * information is not positive definite or whose numbers are not finite, naming them; also if the
   * information is too uneven for start = chordal. */
  PoseGraphResult solve(PoseGraph& graph) const;

  /** Sum of e' Omega e of the graph as it is; nodes without a pose are initialised from their
   * neighbours. 0 without edges. \throws UserError as solve(). */
  [[nodiscard]] double chi2(const PoseGraph& graph) const;

  [[nodiscard]] const PoseGraphSolverOptions& options() const { return options_; }

 private:
  PoseGraphSolverOptions options_;
};
}  // namespace dyslam
