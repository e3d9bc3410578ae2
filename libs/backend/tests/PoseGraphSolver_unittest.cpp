// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/base/Error.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/mrpt/Conversions.h>
#include <gtest/gtest.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <Eigen/Dense>
#include <random>
#include <string>
#include <vector>

#include "NoisyDrive.h"
#include "RealData.h"

namespace dyslam
{
namespace
{
void addEdge(PoseGraph& graph,
             mrpt::graphs::TNodeID from,
             mrpt::graphs::TNodeID to,
             const Pose& mean,
             const Matrix6& information)
{
  graph.insertEdge(
      from, to, {toMrpt(mean), mrpt::math::CMatrixDouble66(informationToYpr(mean, information))});
}

Pose noisy(const Pose& pose, std::mt19937& rng, double translation_sigma, double rotation_sigma)
{
  std::normal_distribution<double> n;
  Vector6 x = Vector6::NullaryExpr([&] { return n(rng); });
  x.head<3>() *= translation_sigma;
  x.tail<3>() *= rotation_sigma;
  return pose * expSE3(x);
}

struct World
{
  PoseGraph graph;
  std::vector<Pose> truth;
};

/** Twice round a circle with some climbing: noisy odometry, loops between the rounds. */
World twoRounds(unsigned seed, double loop_sigma = 0.02)
{
  std::mt19937 rng(seed);
  World world;
  constexpr std::size_t per_round = 60;
  for (std::size_t i = 0; i < 2 * per_round; ++i)
  {
    const double angle = 2 * M_PI * static_cast<double>(i) / per_round;
    world.truth.push_back(poseFromYpr(30 * std::cos(angle), 30 * std::sin(angle),
                                      2 * std::sin(2 * angle), angle + M_PI / 2,
                                      0.1 * std::cos(angle), 0.05));
  }
  const Pose origin = world.truth[0].inverse();
  for (Pose& pose : world.truth)
  {
    pose = origin * pose;
  }
  Pose estimate = Pose::Identity();
  static_cast<mrpt::poses::CPose3D&>(world.graph.nodes[0]) = toMrpt(estimate);
  for (std::size_t i = 1; i < world.truth.size(); ++i)
  {
    const Pose step = noisy(world.truth[i - 1].inverse() * world.truth[i], rng, 0.05, 0.01);
    estimate = estimate * step;
    static_cast<mrpt::poses::CPose3D&>(world.graph.nodes[i]) = toMrpt(estimate);
    addEdge(world.graph, i - 1, i, step, test::diagonalInformation(0.05, 0.01));
  }
  for (std::size_t i = per_round; i < world.truth.size(); i += 6)
  {
    const std::size_t j = i - per_round;
    const Pose loop = noisy(world.truth[j].inverse() * world.truth[i], rng, loop_sigma, 0.005);
    addEdge(world.graph, j, i, loop, test::diagonalInformation(loop_sigma, 0.005));
  }
  return world;
}

double rmsError(const World& world)
{
  double sum = 0;
  for (std::size_t i = 0; i < world.truth.size(); ++i)
  {
    sum += (toPose(world.graph.nodes.at(i)).translation() - world.truth[i].translation())
               .squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(world.truth.size()));
}

PoseGraphSolverOptions optionsFor(GraphStart start, EdgeResidual residual = EdgeResidual::g2o)
{
  PoseGraphSolverOptions options;
  options.start = start;
  options.residual = residual;
  return options;
}

std::string messageOf(PoseGraph graph, const PoseGraphSolverOptions& options = {})
{
  try
  {
    (void)PoseGraphSolver(options).solve(graph);
  }
  catch (const UserError& error)
  {
    return error.what();
  }
  return "no error";
}

TEST(PoseGraphSolver, LoopsLowerTheErrorFromEveryStart)
{
  const World drifted = twoRounds(1);
  const double before = rmsError(drifted);
  double reference = 0;
  for (const GraphStart start : {GraphStart::file, GraphStart::chordal})
  {
    for (const EdgeResidual residual : {EdgeResidual::log, EdgeResidual::g2o})
    {
      World world = drifted;
      const PoseGraphSolver solver(optionsFor(start, residual));
      const PoseGraphResult result = solver.solve(world.graph);
      EXPECT_TRUE(result.converged) << result.reason;
      EXPECT_LT(result.final_chi2, result.initial_chi2);
      EXPECT_NEAR(solver.chi2(world.graph), result.final_chi2, 1e-6 * result.final_chi2);
      EXPECT_NEAR(solver.chi2(drifted.graph), result.start_chi2, 1e-9 * result.start_chi2);
      EXPECT_LT(rmsError(world), 0.5 * before);
      reference = reference == 0 ? result.final_chi2 : reference;
      EXPECT_NEAR(result.final_chi2 / reference, 1, 1e-3);
      EXPECT_TRUE(toPose(world.graph.nodes.at(0)).isApprox(Pose::Identity(), 1e-12));
    }
  }
  // With noise as in the information matrices, chi2 is about the number of redundant equations.
  EXPECT_GT(reference, 20);
  EXPECT_LT(reference, 110);
}

TEST(PoseGraphSolver, ThreadsChangeTheRoundingAlone)
{
  const World drifted = twoRounds(3);
  PoseGraph graphs[2] = {drifted.graph, drifted.graph};
  for (int k = 0; k < 2; ++k)
  {
    PoseGraphSolverOptions options;
    options.threads = k + 1;
    (void)PoseGraphSolver(options).solve(graphs[k]);
  }
  for (const auto& [id, pose] : graphs[0].nodes)
  {
    EXPECT_TRUE(toPose(pose).isApprox(toPose(graphs[1].nodes.at(id)), 1e-6));
  }
}

TEST(PoseGraphSolver, EmptyAndSingleNodeGraphsConverge)
{
  PoseGraph graph;
  EXPECT_TRUE(PoseGraphSolver({}).solve(graph).converged);
  EXPECT_EQ(PoseGraphSolver({}).chi2(graph), 0);
  static_cast<mrpt::poses::CPose3D&>(graph.nodes[0]) = toMrpt(poseFromYpr(1, 2, 3, 1, 0, 0));
  const PoseGraphResult result = PoseGraphSolver({}).solve(graph);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.final_chi2, 0);
  EXPECT_NEAR(graph.nodes.at(0).x(), 1, 1e-12);
}

TEST(PoseGraphSolver, RootMayStandAnywhereAndHaveAnyId)
{
  for (const GraphStart start : {GraphStart::file, GraphStart::chordal})
  {
    World world = twoRounds(5);
    world.graph.root = 57;
    const Pose T = toPose(world.graph.nodes.at(57));
    const double chi2 = PoseGraphSolver(optionsFor(start)).solve(world.graph).final_chi2;
    EXPECT_TRUE(toPose(world.graph.nodes.at(57)).isApprox(T, 1e-12));
    World other = twoRounds(5);
    EXPECT_NEAR(chi2, PoseGraphSolver(optionsFor(start)).solve(other.graph).final_chi2,
                1e-4 * chi2);
  }
}

TEST(PoseGraphSolver, NodesWithoutPoseAreChained)
{
  World world = twoRounds(6);
  const double chi2 = PoseGraphSolver({}).solve(world.graph).final_chi2;
  World bare = twoRounds(6);
  bare.graph.nodes.clear();
  const PoseGraphResult result = PoseGraphSolver(optionsFor(GraphStart::file)).solve(bare.graph);
  EXPECT_EQ(bare.graph.nodes.size(), bare.truth.size());
  EXPECT_NEAR(result.final_chi2, chi2, 1e-5 * chi2);
}

TEST(PoseGraphSolver, ChordalStartThatFailsIsTold)
{
  // Beside the second edge's information that of the first is lost in the rounding.
  const auto graph = []
  {
    PoseGraph g;
    addEdge(g, 0, 1, poseFromYpr(1, 0, 0, 0, 0, 0), test::diagonalInformation(1, 1));
    addEdge(g, 1, 2, poseFromYpr(1, 0, 0, 0, 0, 0), test::diagonalInformation(0x1p-30, 0x1p-30));
    return g;
  };
  PoseGraph uneven = graph();
  EXPECT_THROW((void)PoseGraphSolver(optionsFor(GraphStart::chordal)).solve(uneven), UserError);
  (void)PoseGraphSolver(optionsFor(GraphStart::file)).solve(uneven);
  EXPECT_NEAR(uneven.nodes.at(2).x(), 2, 1e-6);
}

TEST(PoseGraphSolver, TwoEdgesBetweenTheSameNodesBothCount)
{
  PoseGraph graph;
  addEdge(graph, 0, 1, poseFromYpr(1, 0, 0, 0, 0, 0), test::diagonalInformation(0.1, 0.1));
  addEdge(graph, 0, 1, poseFromYpr(2, 0, 0, 0, 0, 0), test::diagonalInformation(0.1, 0.1));
  addEdge(graph, 1, 0, poseFromYpr(-3, 0, 0, 0, 0, 0), test::diagonalInformation(0.1, 0.1));
  const PoseGraphResult result = PoseGraphSolver({}).solve(graph);
  EXPECT_NEAR(graph.nodes.at(1).x(), 2, 1e-9);
  EXPECT_NEAR(result.final_chi2, 200, 1e-6);
}

TEST(PoseGraphSolver, BadGraphsAreNamed)
{
  const World world = twoRounds(7);
  PoseGraph graph = world.graph;
  graph.root = 5000;
  EXPECT_NE(messageOf(graph).find("node 5000, is not in the graph"), std::string::npos);

  graph = world.graph;
  static_cast<mrpt::poses::CPose3D&>(graph.nodes[777]) = toMrpt(Pose::Identity());
  addEdge(graph, 777, 778, Pose::Identity(), Matrix6::Identity());
  EXPECT_NE(messageOf(graph).find("2 of 122 nodes, the first of them node 777"), std::string::npos)
      << messageOf(graph);

  Matrix6 indefinite = Matrix6::Identity();
  indefinite(0, 1) = indefinite(1, 0) = 2;
  graph = world.graph;
  addEdge(graph, 3, 40, Pose::Identity(), indefinite);
  EXPECT_NE(messageOf(graph).find("edge 3 -> 40 is not positive definite; correct it or set "
                                  "pose_graph.indefinite_information=project"),
            std::string::npos);
  PoseGraphSolverOptions project;
  project.indefinite_information = IndefiniteInformation::project;
  EXPECT_EQ(PoseGraphSolver(project).solve(graph).projected_edges, 1U);

  for (const Matrix6& none : {Matrix6(Matrix6::Zero()), Matrix6(-Matrix6::Identity())})
  {
    graph = world.graph;
    addEdge(graph, 3, 40, Pose::Identity(), none);
    EXPECT_NE(messageOf(graph).find("edge 3 -> 40"), std::string::npos);
    EXPECT_NE(messageOf(graph, project).find("edge 3 -> 40"), std::string::npos);
  }

  graph = world.graph;
  addEdge(graph, 3, 40, Pose::Identity(), Matrix6::Constant(NAN));
  EXPECT_NE(messageOf(graph, project).find("edge 3 -> 40 has numbers that are not finite"),
            std::string::npos);
  graph = world.graph;
  addEdge(graph, 3, 3, Pose::Identity(), Matrix6::Identity());
  EXPECT_NE(messageOf(graph).find("edge 3 -> 3 connects a node to itself"), std::string::npos);
}

TEST(PoseGraphSolver, OptionsAreChecked)
{
  PoseGraphSolverOptions options;
  options.threads = 0;
  try
  {
    const PoseGraphSolver solver(options);
    FAIL() << "no exception";
  }
  catch (const UserError& error)
  {
    EXPECT_NE(std::string(error.what()).find("pose_graph"), std::string::npos) << error.what();
  }
}

struct KnownSet
{
  const char* name;
  double best_chi2;
  GraphStart start;
};

class KnownOptimum : public ::testing::TestWithParam<KnownSet>
{
};

TEST_P(KnownOptimum, IsReached)
{
  DYSLAM_REQUIRE_DATA("pose_graphs");
  PoseGraph graph = readPoseGraph(*realDataFolder("pose_graphs") + "/" + GetParam().name + ".g2o");
  PoseGraphSolverOptions options = optionsFor(GetParam().start);
  options.indefinite_information = std::string(GetParam().name) == "cubicle"
                                       ? IndefiniteInformation::project
                                       : IndefiniteInformation::error;
  const PoseGraphResult result = PoseGraphSolver(options).solve(graph);
  EXPECT_TRUE(result.converged) << result.reason;
  EXPECT_NEAR(result.final_chi2 / GetParam().best_chi2, 1, 1e-5);
}

// Best known values by g2o's definition, from the notes beside the data.
INSTANTIATE_TEST_SUITE_P(Sets,
                         KnownOptimum,
                         ::testing::Values(KnownSet{"sphere2500", 727.1497, GraphStart::file},
                                           KnownSet{"sphere2500", 727.1497, GraphStart::chordal},
                                           KnownSet{"parking-garage", 1.23869, GraphStart::file},
                                           KnownSet{"parking-garage", 1.23869, GraphStart::chordal},
                                           KnownSet{"torus3D", 14574.75, GraphStart::chordal},
                                           KnownSet{"cubicle", 2379.917, GraphStart::chordal},
                                           KnownSet{"kitti_00", 98.3220, GraphStart::file},
                                           KnownSet{"kitti_02", 78.7643, GraphStart::file},
                                           KnownSet{"kitti_05", 157.1044, GraphStart::file},
                                           KnownSet{"manhattan", 3549.0368, GraphStart::chordal},
                                           KnownSet{"city10000", 511.985, GraphStart::chordal},
                                           KnownSet{"intel", 45.0047, GraphStart::chordal},
                                           KnownSet{"MIT", 41.163, GraphStart::chordal},
                                           KnownSet{"CSAIL", 40.5551, GraphStart::chordal},
                                           KnownSet{"smallGrid3D", 458.154, GraphStart::chordal}),
                         [](const auto& parameter)
                         {
                           std::string name = parameter.param.name;
                           name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
                           return name + (parameter.param.start == GraphStart::file ? "_file"
                                                                                    : "_chordal");
                         });
}  // namespace
}  // namespace dyslam
