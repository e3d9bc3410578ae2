// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/core/Error.h>

#include <array>
#include <utility>

#include "EdgeCost.h"
#include "GraphData.h"
#include "InitialGuess.h"

namespace dyslam
{
namespace
{
/** Poses as blocks that Ceres moves; planar graphs have three numbers per node. */
class Blocks
{
 public:
  Blocks(const GraphData& data, bool planar)
      : planar_(planar), width_(planar ? 3 : pose_block_size), values_(data.size() * width_)
  {
    for (std::size_t i = 0; i < data.size(); ++i)
    {
      if (planar_)
      {
        Eigen::Map<Eigen::Vector3d>{block(i)} << data.poses[i].translation().head<2>(),
            yawPitchRoll(data.poses[i]).x();
      }
      else
      {
        packPose(data.poses[i], block(i));
      }
    }
  }

  [[nodiscard]] double* block(std::size_t i) { return values_.data() + i * width_; }
  [[nodiscard]] int width() const { return static_cast<int>(width_); }

  [[nodiscard]] Pose pose(std::size_t i)
  {
    const double* b = block(i);
    return planar_ ? poseFromYpr(b[0], b[1], 0, b[2], 0, 0) : unpackPose(b);
  }

 private:
  bool planar_;
  std::size_t width_;
  std::vector<double> values_;
};

bool inPlane(const GraphData& data, const PoseGraphSolverOptions& options)
{
  return data.planar && options.residual == EdgeResidual::g2o;
}

ErrorCoordinates coordinatesFor(const GraphData& data, const PoseGraphSolverOptions& options)
{
  if (options.residual == EdgeResidual::log)
  {
    return ErrorCoordinates::log;
  }
  return data.planar ? ErrorCoordinates::split_log : ErrorCoordinates::quaternion;
}

double chi2Of(const GraphData& data, const PoseGraphSolverOptions& options)
{
  const ErrorCoordinates coordinates = coordinatesFor(data, options);
  double sum = 0;
  for (const GraphEdge& edge : data.edges)
  {
    const Vector6 error =
        edgeError(coordinates, edge.T_from_to, data.poses[edge.from], data.poses[edge.to]);
    sum += error.dot(edge.information * error);
  }
  return sum;
}

std::unique_ptr<ceres::LossFunction> makeLoss(const PoseGraphSolverOptions& options)
{
  switch (options.loop_kernel)
  {
    case RobustKernel::huber:
      return std::make_unique<ceres::HuberLoss>(options.kernel_width);
    case RobustKernel::cauchy:
      return std::make_unique<ceres::CauchyLoss>(options.kernel_width);
    case RobustKernel::dcs:
      return makeDcsLoss(options.kernel_width);
    case RobustKernel::none:
      break;
  }
  return nullptr;
}

void setLinearSolver(ceres::Solver::Options& ceres_options, GraphLinearSolver linear_solver)
{
  switch (linear_solver)
  {
    case GraphLinearSolver::suite_sparse:
      ceres_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
      ceres_options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
      break;
    case GraphLinearSolver::eigen_sparse:
      ceres_options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
      ceres_options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
      break;
    case GraphLinearSolver::conjugate_gradients:
      ceres_options.linear_solver_type = ceres::CGNR;
      ceres_options.preconditioner_type = ceres::JACOBI;
      break;
  }
}

void setStart(GraphData& data, GraphStart start)
{
  switch (start)
  {
    case GraphStart::file:
      completePoses(data);
      break;
    case GraphStart::spanning_tree:
      spanningTreePoses(data);
      break;
    case GraphStart::chordal:
      chordalPoses(data);
      break;
  }
}

/** Runs Ceres from data.poses and puts the answer there. */
ceres::Solver::Summary optimise(GraphData& data, const PoseGraphSolverOptions& options)
{
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.disable_all_safety_checks = true;
  PoseManifold manifold;
  const std::unique_ptr<ceres::LossFunction> loss = makeLoss(options);
  const bool planar = inPlane(data, options);
  const ErrorCoordinates coordinates = coordinatesFor(data, options);
  Blocks blocks(data, planar);
  ceres::Problem problem(problem_options);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    problem.AddParameterBlock(blocks.block(i), blocks.width(), planar ? nullptr : &manifold);
  }
  problem.SetParameterBlockConstant(blocks.block(data.root));
  for (const GraphEdge& edge : data.edges)
  {
    auto cost = planar ? makePlanarEdgeCost(edge) : makeEdgeCost(coordinates, edge);
    problem.AddResidualBlock(cost.release(), edge.loop ? loss.get() : nullptr,
                             blocks.block(edge.from), blocks.block(edge.to));
  }
  ceres::Solver::Options ceres_options;
  setLinearSolver(ceres_options, options.linear_solver);
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.function_tolerance = options.tolerance;
  ceres_options.gradient_tolerance = 1e-14;
  ceres_options.parameter_tolerance = 1e-12;
  ceres_options.initial_trust_region_radius = 1e8;
  ceres_options.num_threads = options.threads;
  ceres_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(ceres_options, &problem, &summary);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      data.poses[i] = blocks.pose(i);
    }
  }
  return summary;
}
}  // namespace

void PoseGraphSolverOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer("max_iterations", max_iterations, 0, 10000, "steps of the optimisation");
  visitor.real("tolerance", tolerance, 0, 1, "stop when a step lowers the cost by less than this");
  visitor.choice("residual", residual, {{"log", EdgeResidual::log}, {"g2o", EdgeResidual::g2o}},
                 "coordinates of an edge's misfit");
  visitor.choice("loop_kernel", loop_kernel,
                 {{"none", RobustKernel::none},
                  {"huber", RobustKernel::huber},
                  {"cauchy", RobustKernel::cauchy},
                  {"dcs", RobustKernel::dcs}},
                 "what tames loops that do not fit");
  visitor.real("kernel_width", kernel_width, 1e-6, 1e6, "whitened misfit where it sets in");
  visitor.choice("start", start,
                 {{"file", GraphStart::file},
                  {"spanning_tree", GraphStart::spanning_tree},
                  {"chordal", GraphStart::chordal}},
                 "poses the optimisation starts from");
  visitor.choice("linear_solver", linear_solver,
                 {{"suite_sparse", GraphLinearSolver::suite_sparse},
                  {"eigen_sparse", GraphLinearSolver::eigen_sparse},
                  {"conjugate_gradients", GraphLinearSolver::conjugate_gradients}},
                 "how the normal equations are solved");
  visitor.choice(
      "indefinite_information", indefinite_information,
      {{"error", IndefiniteInformation::error}, {"project", IndefiniteInformation::project}},
      "edges whose information is not positive definite");
  visitor.integer("threads", threads, 1, 256, "threads");
}

PoseGraphSolver::PoseGraphSolver(const PoseGraphSolverOptions& options) : options_(options)
{
  validate(options_, "solver");
}

PoseGraphResult PoseGraphSolver::solve(PoseGraph& graph) const
{
  GraphData data = unroll(graph, options_.indefinite_information);
  PoseGraphResult result;
  result.projected_edges = data.projected_edges;
  if (data.edges.empty())
  {
    result.converged = true;
    result.reason = "no edges";
    return result;
  }
  completePoses(data);
  result.start_chi2 = chi2Of(data, options_);
  setStart(data, options_.start);
  result.initial_chi2 = chi2Of(data, options_);
  const ceres::Solver::Summary summary = optimise(data, options_);
  result.final_chi2 = chi2Of(data, options_);
  result.iterations = summary.num_successful_steps + summary.num_unsuccessful_steps - 1;
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.reason = summary.message;
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    auto& node = graph.nodes[data.ids[i]];
    static_cast<mrpt::poses::CPose3D&>(node) = toMrptPose(data.poses[i]);
  }
  return result;
}

double PoseGraphSolver::chi2(const PoseGraph& graph) const
{
  GraphData data = unroll(graph, options_.indefinite_information);
  completePoses(data);
  return chi2Of(data, options_);
}
}  // namespace dyslam
