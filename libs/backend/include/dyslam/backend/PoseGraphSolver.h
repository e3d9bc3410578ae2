// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PoseGraph.h>
#include <dyslam/base/Options.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Parametrisation of an edge's error E = T_measured^-1 T_i^-1 T_j as a residual. Both agree to
 * first order, so they share one information matrix. */
enum class EdgeResidual
{
  log,  //!< log(E) in SE(3), as in the paper
  g2o,  //!< translation of E and twice its quaternion's vector part; planar graphs: and heading
};

/** Initial values of the poses. */
enum class GraphStart
{
  file,     //!< the graph's own poses; nodes without one are initialised from their neighbours
  chordal,  //!< linear least squares on rotation matrices, then on translations
};

/** Treatment of an edge whose information matrix is not positive definite. */
enum class IndefiniteInformation
{
  error,    //!< throw UserError, naming the edge
  project,  //!< raise the eigenvalues to at least 1e-9 of the largest
};

struct PoseGraphSolverOptions : Options
{
  int max_iterations = 100;
  double tolerance = 1e-9;  //!< stop when a step lowers the cost by less than this fraction
  EdgeResidual residual = EdgeResidual::g2o;
  GraphStart start = GraphStart::chordal;
  IndefiniteInformation indefinite_information = IndefiniteInformation::error;
  int threads = 1;  //!< more than 1: the result varies by rounding errors

  void describe(OptionsVisitor& visitor) override;
};

struct PoseGraphResult
{
  double start_chi2 = 0;    //!< chi2 of the graph's own poses, missing ones chained
  double initial_chi2 = 0;  //!< chi2 of the initial values of the optimisation
  double final_chi2 = 0;    //!< chi2 after it: sum of e' Omega e over all edges
  int iterations = 0;
  std::size_t projected_edges = 0;  //!< number of edges with projected information matrix
  bool converged = false;
  std::string reason;  //!< why the solver stopped
};

/** Least-squares optimisation of a pose graph.
 *
 * With `residual = g2o`, chi2 is the value that g2o prints. Graphs whose poses, measurements and
 * information matrices are all planar are solved in the plane.
 * Thread-safe: solve() is const.
 */
class PoseGraphSolver
{
 public:
  explicit PoseGraphSolver(const PoseGraphSolverOptions& options);

  /** Optimises the poses of all nodes except the root, which is fixed (at identity if it has no
   * pose). A graph of at most one node converges at once.
   * \throws UserError for a node that is not connected to the root, and for an edge whose
   * information is not positive definite or whose numbers are not finite, naming them; also if the
   * information is too uneven for start = chordal. */
  PoseGraphResult solve(PoseGraph& graph) const;

  /** Sum of e' Omega e over all edges at the graph's poses; nodes without a pose are initialised
   * from their neighbours. 0 for at most one node. \throws UserError as solve(). */
  [[nodiscard]] double chi2(const PoseGraph& graph) const;

  [[nodiscard]] const PoseGraphSolverOptions& options() const { return options_; }

 private:
  PoseGraphSolverOptions options_;
};
}  // namespace dyslam
