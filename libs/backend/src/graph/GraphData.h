// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/PoseGraphSolver.h>
#include <dyslam/core/Pose.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <cstddef>
#include <vector>

namespace dyslam
{
/** Edge between nodes numbered from 0; information over the tangent of the measurement. */
struct GraphEdge
{
  std::size_t from = 0;
  std::size_t to = 0;
  Pose T_from_to = Pose::Identity();
  Matrix6 information = Matrix6::Identity();
};

/** A pose graph as arrays. */
struct GraphData
{
  std::vector<mrpt::graphs::TNodeID> ids;  //!< ids of the nodes, ascending
  std::vector<Pose> poses;
  std::vector<bool> has_pose;
  std::vector<GraphEdge> edges;
  std::size_t root = 0;
  bool planar = false;
  std::size_t projected_edges = 0;  //!< number of edges with projected information matrix

  [[nodiscard]] std::size_t size() const { return ids.size(); }
};

/** Checks a graph and copies it to arrays. \throws UserError as PoseGraphSolver::solve(). */
[[nodiscard]] GraphData unroll(const mrpt::graphs::CNetworkOfPoses3DInf& graph,
                               IndefiniteInformation indefinite);

/** For every node the edges that touch it, in order: adjacency[first[k] .. first[k + 1]). */
struct Adjacency
{
  std::vector<std::size_t> first;
  std::vector<std::size_t> edges;
};
[[nodiscard]] Adjacency adjacencyOf(const GraphData& data);
}  // namespace dyslam
