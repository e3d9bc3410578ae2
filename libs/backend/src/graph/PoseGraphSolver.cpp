// SPDX-License-Identifier: BSD-3-Clause
#include <ceres/ceres.h>
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/base/Error.h>
#include <dyslam/mrpt/Conversions.h>

#include "CeresOptions.h"
#include "EdgeCost.h"
#include "GraphData.h"
#include "InitialGuess.h"

namespace dyslam
{
namespace
{
/** Poses as parameter blocks of Ceres; planar graphs have three numbers per node. */
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

/** A pose graph as a Ceres problem. */
class GraphProblem
{
 public:
  GraphProblem(const GraphData& data, const PoseGraphSolverOptions& options)
      : options_(options),
        planar_(inPlane(data, options)),
        coordinates_(coordinatesFor(data, options)),
        blocks_(data, planar_),
        problem_(problemOptions())
  {
    for (std::size_t i = 0; i < data.size(); ++i)
    {
      problem_.AddParameterBlock(blocks_.block(i), blocks_.width(), planar_ ? nullptr : &manifold_);
    }
    problem_.SetParameterBlockConstant(blocks_.block(data.root));
    for (const GraphEdge& edge : data.edges)
    {
      auto cost = planar_ ? makePlanarEdgeCost(edge) : makeEdgeCost(coordinates_, edge);
      problem_.AddResidualBlock(cost.release(), nullptr, blocks_.block(edge.from),
                                blocks_.block(edge.to));
    }
  }

  ceres::Solver::Summary solve()
  {
    ceres::Solver::Summary summary;
    ceres::Solve(sparseSolverOptions(options_.max_iterations, options_.tolerance, options_.threads),
                 &problem_, &summary);
    return summary;
  }

  [[nodiscard]] Pose pose(std::size_t i) { return blocks_.pose(i); }

 private:
  static ceres::Problem::Options problemOptions()
  {
    ceres::Problem::Options options;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    return options;
  }

  const PoseGraphSolverOptions& options_;
  bool planar_;
  ErrorCoordinates coordinates_;
  Blocks blocks_;
  PoseManifold manifold_;
  ceres::Problem problem_;
};

/** Optimises data.poses in place and fills the result. */
void optimise(GraphData& data, const PoseGraphSolverOptions& options, PoseGraphResult& result)
{
  GraphProblem problem(data, options);
  const ceres::Solver::Summary summary = problem.solve();
  result.iterations = stepsOf(summary);
  result.converged = summary.termination_type == ceres::CONVERGENCE;
  result.reason = summary.message;
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      data.poses[i] = problem.pose(i);
    }
  }
}
}  // namespace

void PoseGraphSolverOptions::describe(OptionsVisitor& visitor)
{
  visitor.integer("max_iterations", max_iterations, 0, 10000,
                  "upper limit of the solver's iterations");
  visitor.real("tolerance", tolerance, 0, 1,
               "relative decrease of the cost in a step below which the solver stops");
  visitor.choice("residual", residual, {{"log", EdgeResidual::log}, {"g2o", EdgeResidual::g2o}},
                 "parametrisation of an edge's residual");
  visitor.choice("start", start, {{"file", GraphStart::file}, {"chordal", GraphStart::chordal}},
                 "initial values of the poses: those of the file, or chordal initialisation");
  visitor.choice(
      "indefinite_information", indefinite_information,
      {{"error", IndefiniteInformation::error}, {"project", IndefiniteInformation::project}},
      "treatment of edges whose information matrix is not positive definite");
  visitor.integer("threads", threads, 1, 256, "threads of the solver");
}

PoseGraphSolver::PoseGraphSolver(const PoseGraphSolverOptions& options) : options_(options)
{
  validate(options_, "pose_graph");
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
  if (options_.start == GraphStart::chordal)
  {
    chordalPoses(data);
  }
  result.initial_chi2 = chi2Of(data, options_);
  optimise(data, options_, result);
  result.final_chi2 = chi2Of(data, options_);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    auto& node = graph.nodes[data.ids[i]];
    static_cast<mrpt::poses::CPose3D&>(node) = toMrpt(data.poses[i]);
  }
  return result;
}

double PoseGraphSolver::chi2(const PoseGraph& graph) const
{
  GraphData data = unroll(graph, options_.indefinite_information);
  if (data.edges.empty())
  {
    return 0;
  }
  completePoses(data);
  return chi2Of(data, options_);
}
}  // namespace dyslam
