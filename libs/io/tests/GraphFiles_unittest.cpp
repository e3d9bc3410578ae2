// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/io/GraphFiles.h>
#include <dyslam/mrpt/Conversions.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
using Graph = mrpt::graphs::CNetworkOfPoses3DInf;

Graph randomGraph(unsigned seed)
{
  std::mt19937 rng(seed);
  std::normal_distribution<double> n;
  Graph graph;
  graph.root = 3;
  for (mrpt::graphs::TNodeID id = 3; id < 13; ++id)
  {
    const Vector6 x = Vector6::NullaryExpr([&] { return n(rng); });
    static_cast<mrpt::poses::CPose3D&>(graph.nodes[id]) = toMrpt(expSE3(x));
  }
  for (mrpt::graphs::TNodeID id = 3; id < 12; ++id)
  {
    for (int copy = 0; copy < (id == 5 ? 2 : 1); ++copy)
    {
      const Vector6 x = Vector6::NullaryExpr([&] { return n(rng); });
      const Matrix6 a = Matrix6::NullaryExpr([&] { return n(rng); });
      const Matrix6 information = a * a.transpose() + Matrix6::Identity();
      graph.insertEdge(id, id + 1, {toMrpt(expSE3(x)), mrpt::math::CMatrixDouble66(information)});
    }
  }
  return graph;
}

void expectSame(const Graph& a, const Graph& b, double tolerance)
{
  ASSERT_EQ(a.nodes.size(), b.nodes.size());
  ASSERT_EQ(a.edges.size(), b.edges.size());
  EXPECT_EQ(a.root, b.root);
  for (const auto& [id, pose] : a.nodes)
  {
    EXPECT_TRUE(toPose(pose).isApprox(toPose(b.nodes.at(id)), tolerance));
  }
  auto other = b.edges.begin();
  for (const auto& [ids, edge] : a.edges)
  {
    EXPECT_EQ(ids, other->first);
    EXPECT_TRUE(toPose(edge.mean).isApprox(toPose(other->second.mean), tolerance));
    EXPECT_TRUE(edge.cov_inv.asEigen().isApprox(other->second.cov_inv.asEigen(), tolerance));
    ++other;
  }
}

class GraphFiles : public ::testing::Test
{
 protected:
  std::string write(const std::string& text)
  {
    const std::string path = folder_.file("graph.g2o");
    std::ofstream(path) << text;
    return path;
  }

  std::string errorOf(const std::string& text)
  {
    try
    {
      (void)readPoseGraph(write(text));
    }
    catch (const UserError& error)
    {
      return error.what();
    }
    return "no error";
  }

  void expectError(const std::string& text, const std::string& part)
  {
    EXPECT_NE(errorOf(text).find(part), std::string::npos) << errorOf(text);
  }

  TestFolder folder_;
};

TEST_F(GraphFiles, GraphTextKeepsEveryDigit)
{
  const Graph graph = randomGraph(1);
  writeGraph(graph, folder_.file("a.graph"));
  expectSame(graph, readPoseGraph(folder_.file("a.graph")), 1e-13);
}

TEST_F(GraphFiles, MrptReadsOurGraphTextAlike)
{
  Graph graph = randomGraph(2);
  writeGraph(graph, folder_.file("a.graph"));
  // MRPT 2.5.8 drops what it reads of the information between two of the angles.
  for (auto& [ids, edge] : graph.edges)
  {
    const Eigen::Matrix3d angles = edge.cov_inv.asEigen().bottomRightCorner<3, 3>();
    edge.cov_inv.asEigen().bottomRightCorner<3, 3>() = angles.diagonal().asDiagonal();
  }
  Graph theirs;
  theirs.loadFromTextFile(folder_.file("a.graph"), false);  // keep double edges
  expectSame(graph, theirs, 1e-13);
}

TEST_F(GraphFiles, WeReadMrptsGraphTextAlike)
{
  const Graph graph = randomGraph(3);
  graph.saveToTextFile(folder_.file("a.graph"));
  expectSame(graph, readPoseGraph(folder_.file("a.graph")), 1e-4);  // MRPT writes six digits
}

TEST_F(GraphFiles, G2oTextKeepsEveryDigit)
{
  const Graph graph = randomGraph(4);
  writeG2o(graph, folder_.file("a.g2o"));
  expectSame(graph, readPoseGraph(folder_.file("a.g2o")), 1e-9);
}

TEST_F(GraphFiles, G2oInformationIsAboutHalfTheRotation)
{
  const Graph graph =
      readPoseGraph(write("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"
                          "VERTEX_SE3:QUAT 1 1 2 3 0 0 0 1\n"
                          "EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1 "
                          "10 0 0 0 0 0 20 0 0 0 0 30 0 0 0 400 0 0 500 0 600\n"));
  const Matrix6 information = graph.edges.begin()->second.cov_inv.asEigen();
  Vector6 expected;
  expected << 10, 20, 30, 150, 125, 100;  // yaw pitch roll, a quarter each
  EXPECT_TRUE(information.isApprox(Matrix6(expected.asDiagonal()), 1e-12)) << information;
}

TEST_F(GraphFiles, PlanarLinesAreLifted)
{
  const Graph graph =
      readPoseGraph(write("# a comment\n\nVERTEX_SE2 4 0 0 0\r\nVERTEX_SE2 5 1 2 1.5\nFIX 5\n"
                          "EDGE_SE2 4 5 1 2 1.5 10 1 2 30 3 500\n"));
  EXPECT_EQ(graph.root, 5U);
  const auto& edge = graph.edges.begin()->second;
  const Pose mean = toPose(edge.mean);
  EXPECT_TRUE(mean.isApprox(poseFromYpr(1, 2, 0, 1.5, 0, 0), 1e-12));
  Matrix6 expected = Matrix6::Zero();
  expected.diagonal() << 10, 30, 20, 500, 500, 500;
  expected(0, 1) = expected(1, 0) = 1;
  expected(0, 5) = expected(5, 0) = 2;
  expected(1, 5) = expected(5, 1) = 3;
  EXPECT_TRUE(informationFromYpr(mean, edge.cov_inv.asEigen()).isApprox(expected, 1e-12));
}

TEST_F(GraphFiles, ToroOrdersThePlanarInformationInItsOwnWay)
{
  const Graph graph =
      readPoseGraph(write("VERTEX2 4 0 0 0\nVERTEX2 5 1 2 1.5\n"
                          "EDGE2 4 5 1 2 1.5 10 1 30 500 2 3\n"));
  EXPECT_TRUE(toPose(graph.nodes.at(5)).isApprox(poseFromYpr(1, 2, 0, 1.5, 0, 0), 1e-12));
  const auto& edge = graph.edges.begin()->second;
  EXPECT_TRUE(toPose(edge.mean).isApprox(poseFromYpr(1, 2, 0, 1.5, 0, 0), 1e-12));
  Matrix6 expected = Matrix6::Zero();  // x, y, z, yaw, pitch, roll
  expected.diagonal() << 10, 30, 20, 500, 500, 500;
  expected(0, 1) = expected(1, 0) = 1;
  expected(0, 3) = expected(3, 0) = 2;
  expected(1, 3) = expected(3, 1) = 3;
  EXPECT_TRUE(edge.cov_inv.asEigen().isApprox(expected, 1e-12)) << edge.cov_inv.asEigen();
}

TEST_F(GraphFiles, EdgesWithoutInformationHaveTheIdentity)
{
  std::vector<std::string> warnings;
  const Graph graph =
      readPoseGraph(write("EDGE_SE3:QUAT 0 1 1 2 3 0 0 0 1\nEDGE_SE2 1 2 1 2 0 # a comment\n"
                          "EDGE2 2 3 1 2 0\nEDGE3 3 4 1 2 3 0 0 0\n"
                          "EDGE_SE2 4 5 1 2 0 1 0 0 1 0 1\n"),
                    &warnings);
  ASSERT_EQ(graph.edges.size(), 5U);
  Vector6 expected = Vector6::Ones();
  expected.tail<3>().setConstant(0.25);  // the vector part of a quaternion is half the rotation
  for (const auto& [ids, edge] : graph.edges)
  {
    EXPECT_TRUE(edge.cov_inv.asEigen().isApprox(Matrix6(expected.asDiagonal()), 1e-12))
        << ids.first;
    expected.setOnes();
  }
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings[0].find("graph.g2o: 4 edges without an information matrix"), std::string::npos)
      << warnings[0];
}

TEST_F(GraphFiles, NodesWithoutVertexLineStayAway)
{
  const Graph graph = readPoseGraph(write("EDGE_SE2 7 9 1 2 1.5 10 0 0 30 0 500\n"));
  EXPECT_TRUE(graph.nodes.empty());
  EXPECT_EQ(graph.root, 7U);
}

TEST_F(GraphFiles, ErrorsNameFileLineAndField)
{
  const std::string vertex = "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n";
  expectError(vertex + "VERTEX_SE3:QUAT 1 0 x 0 0 0 0 1\n", "graph.g2o:2: field 4 (y): 'x' stands");
  expectError(vertex + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0\n", ":2: field 9 (qw): the line ends");
  expectError(vertex + "VERTEX_SE3:QUAT 1 0 0 nan 0 0 0 1\n", "(z): 'nan' stands where a finite");
  expectError(vertex + "VERTEX_SE3:QUAT 1 0 0 0 0 0 0 0\n", ":2: quaternion of length 0");
  expectError(vertex + vertex, ":2: vertex 0 is there twice");
  expectError(vertex + "VERTEX_SE3:QUAT -1 0 0 0 0 0 0 1\n", "(id): '-1' stands where a node");
  expectError(vertex + "VERTEX_SE2 1 0 0 0 0\n", ":2: field 6 (end of line): '0' stands");
  expectError("EDGE_SE2 1 1 1 2 1.5 10 0 0 30 0 500\n", "edge from node 1 to itself");
  expectError("EDGE_SE2 1 2 1 2 1.5 10 0 0 30 0\n", "field 12 (information 3,3): the line ends");
  expectError("EDGE_SE3:QAUT 1 2\n", "did you mean 'EDGE_SE3:QUAT'?");
  expectError("EDGE2 1 2 1 2 1.5 10 0 0 30 0 500\n", "write VERTEX_SE2 and EDGE_SE2");
  expectError("EDGE2 1 2 1 2 1.5 10 0 0 30 0 500\n", "not positive definite in TORO's order");
  expectError("ODOMETRY 1 2 1 2 1.5 10 0 0 30 0 500\n", "write VERTEX_SE2 and EDGE_SE2");
  expectError(vertex + "EDGE_SE3_PRIOR 0 0 0 0 0 0 0 0 1\n",
              ":2: 'EDGE_SE3_PRIOR' is not supported, only poses and edges between two of them");
  expectError("VERTEX_TRACKXYZ 3 0 0 0\n", "remove the lines of this type");
  expectError("EQUIV 3 4\n", ":1: 'EQUIV' is not supported");
  expectError("ply\n", ":1: unknown entry 'ply'");
  expectError(std::string("\x1f\x8b\x08\x00\n\xff", 6), ":1: is not text");
  expectError(vertex + "FIX 0\nFIX 1\n", ":3: a second FIX");
  expectError(vertex + "FIX 7\n", "FIX 7 names a node without VERTEX and EDGE");
  expectError("", "has no VERTEX or EDGE line");
  EXPECT_THROW((void)readPoseGraph(folder_.file("missing.graph")), UserError);
  EXPECT_THROW(writeGraph(randomGraph(1), folder_.file("no/such/folder.graph")), UserError);
  EXPECT_THROW(writeG2o(randomGraph(1), folder_.file("no/such/folder.g2o")), UserError);
}

TEST_F(GraphFiles, AFullDiskLeavesTheEarlierFile)
{
  folder_.write("a.g2o", "an earlier one");
  const test::FullDisk full_disk;
  EXPECT_THROW(writeG2o(randomGraph(1), folder_.file("a.g2o")), UserError);
  EXPECT_EQ("an earlier one", folder_.read("a.g2o"));
}

TEST_F(GraphFiles, GraphSlamProgramAcceptsOurFile)
{
  if (std::system("command -v graph-slam >/dev/null") != 0)
  {
    GTEST_SKIP() << "MRPT's graph-slam is not installed";
  }
  // A square walked with noise, closed by one edge.
  Graph graph;
  Pose pose = Pose::Identity();
  const Pose step = poseFromYpr(1, 0, 0, M_PI / 2, 0, 0);
  for (mrpt::graphs::TNodeID id = 0; id < 4; ++id)
  {
    static_cast<mrpt::poses::CPose3D&>(graph.nodes[id]) = toMrpt(pose);
    pose = pose * poseFromYpr(1.1, 0.02, 0, M_PI / 2 - 0.05, 0, 0);
    graph.insertEdge(id, (id + 1) % 4,
                     {toMrpt(step), mrpt::math::CMatrixDouble66(100 * Matrix6::Identity())});
  }
  writeGraph(graph, folder_.file("in.graph"));
  const std::string command = "graph-slam --3d --levmarq --no-span -i " + folder_.file("in.graph") +
                              " -o " + folder_.file("out.graph") + " >" + folder_.file("log") +
                              " 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const Graph out = readPoseGraph(folder_.file("out.graph"));
  ASSERT_EQ(out.nodes.size(), 4U);
  ASSERT_EQ(out.edges.size(), 4U);
  Pose expected = Pose::Identity();
  for (mrpt::graphs::TNodeID id = 0; id < 4; ++id)
  {
    EXPECT_TRUE(toPose(out.nodes.at(id)).isApprox(expected, 1e-3));
    expected = expected * step;
  }
}
}  // namespace
}  // namespace dyslam
