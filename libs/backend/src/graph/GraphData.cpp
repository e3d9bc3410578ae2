// SPDX-License-Identifier: BSD-3-Clause
#include "GraphData.h"

#include <dyslam/base/Error.h>
#include <dyslam/core/PoseInformation.h>
#include <dyslam/mrpt/Conversions.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <string>

namespace dyslam
{
namespace
{
using mrpt::graphs::TNodeID;

std::string nameOf(const GraphData& data, const GraphEdge& edge)
{
  return "edge " + std::to_string(data.ids[edge.from]) + " -> " + std::to_string(data.ids[edge.to]);
}

std::size_t indexOf(const std::vector<TNodeID>& ids, TNodeID id)
{
  return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

std::vector<TNodeID> allIds(const mrpt::graphs::CNetworkOfPoses3DInf& graph)
{
  std::vector<TNodeID> ids;
  ids.reserve(graph.nodes.size() + 2 * graph.edges.size());
  for (const auto& [id, pose] : graph.nodes)
  {
    ids.push_back(id);
  }
  for (const auto& [pair, edge] : graph.edges)
  {
    ids.push_back(pair.first);
    ids.push_back(pair.second);
  }
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

void requireGood(const GraphData& data, const GraphEdge& edge)
{
  if (edge.from == edge.to)
  {
    throw UserError("pose graph: " + nameOf(data, edge) + " connects a node to itself; remove it");
  }
  if (!edge.T_from_to.matrix().allFinite() || !edge.information.allFinite())
  {
    throw UserError("pose graph: " + nameOf(data, edge) +
                    " has numbers that are not finite; remove or correct it");
  }
}

/** Projects an indefinite matrix. \return true if it was changed */
bool makePositiveDefinite(const GraphData& data, GraphEdge& edge, IndefiniteInformation indefinite)
{
  if (edge.information.llt().info() == Eigen::Success)
  {
    return false;
  }
  if (indefinite == IndefiniteInformation::error)
  {
    throw UserError(
        "pose graph: the information matrix of " + nameOf(data, edge) +
        " is not positive definite; correct it or set pose_graph.indefinite_information=project");
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(edge.information);
  const double floor = 1e-9 * eigen.eigenvalues().maxCoeff();
  if (!(floor > 0))
  {
    throw UserError("pose graph: the information matrix of " + nameOf(data, edge) +
                    " has no positive eigenvalue; correct it or remove the edge");
  }
  edge.information = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(floor).asDiagonal() *
                     eigen.eigenvectors().transpose();
  return true;
}

void requireConnected(const GraphData& data)
{
  const Adjacency adjacency = adjacencyOf(data);
  std::vector<bool> reached(data.size(), false);
  std::vector<std::size_t> queue = {data.root};
  reached[data.root] = true;
  for (std::size_t head = 0; head < queue.size(); ++head)
  {
    const std::size_t node = queue[head];
    for (std::size_t k = adjacency.first[node]; k < adjacency.first[node + 1]; ++k)
    {
      const GraphEdge& edge = data.edges[adjacency.edges[k]];
      const std::size_t other = edge.from == node ? edge.to : edge.from;
      if (!reached[other])
      {
        reached[other] = true;
        queue.push_back(other);
      }
    }
  }
  if (queue.size() == data.size())
  {
    return;
  }
  const auto lost =
      static_cast<std::size_t>(std::find(reached.begin(), reached.end(), false) - reached.begin());
  throw UserError("pose graph: " + std::to_string(data.size() - queue.size()) + " of " +
                  std::to_string(data.size()) + " nodes, the first of them node " +
                  std::to_string(data.ids[lost]) + ", have no chain of edges to the root (node " +
                  std::to_string(data.ids[data.root]) + "); add an edge or split the graph");
}

bool isPlanar(const Pose& pose)
{
  return pose.translation().z() == 0 && pose.linear()(2, 2) == 1;
}

/** Whether no information couples x, y and heading with z, roll and pitch. */
bool isPlanar(const Matrix6& information)
{
  constexpr std::array<Eigen::Index, 3> in_plane = {0, 1, 5};
  constexpr std::array<Eigen::Index, 3> off_plane = {2, 3, 4};
  for (const Eigen::Index r : in_plane)
  {
    for (const Eigen::Index c : off_plane)
    {
      if (std::abs(information(r, c)) > 1e-12 * std::sqrt(information(r, r) * information(c, c)))
      {
        return false;
      }
    }
  }
  return true;
}

bool isPlanar(const GraphData& data)
{
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (data.has_pose[i] && !isPlanar(data.poses[i]))
    {
      return false;
    }
  }
  return std::all_of(data.edges.begin(), data.edges.end(),
                     [](const GraphEdge& edge)
                     { return isPlanar(edge.T_from_to) && isPlanar(edge.information); });
}
}  // namespace

GraphData unroll(const mrpt::graphs::CNetworkOfPoses3DInf& graph, IndefiniteInformation indefinite)
{
  GraphData data;
  data.ids = allIds(graph);
  if (data.ids.empty())
  {
    return data;
  }
  data.root = indexOf(data.ids, graph.root);
  if (data.root == data.size() || data.ids[data.root] != graph.root)
  {
    throw UserError("pose graph: the root, node " + std::to_string(graph.root) +
                    ", is not in the graph; set root to one of its nodes");
  }
  data.poses.assign(data.size(), Pose::Identity());
  data.has_pose.assign(data.size(), false);
  for (const auto& [id, pose] : graph.nodes)
  {
    const std::size_t i = indexOf(data.ids, id);
    data.poses[i] = toPose(pose);
    data.has_pose[i] = true;
    if (!data.poses[i].matrix().allFinite())
    {
      throw UserError("pose graph: the pose of node " + std::to_string(id) +
                      " is not finite; correct it or remove it");
    }
  }
  data.has_pose[data.root] = true;
  data.edges.reserve(graph.edges.size());
  for (const auto& [pair, measured] : graph.edges)
  {
    GraphEdge edge;
    edge.from = indexOf(data.ids, pair.first);
    edge.to = indexOf(data.ids, pair.second);
    edge.T_from_to = toPose(measured.mean);
    edge.information = informationFromYpr(edge.T_from_to, measured.cov_inv.asEigen());
    requireGood(data, edge);
    data.projected_edges += makePositiveDefinite(data, edge, indefinite) ? 1 : 0;
    data.edges.push_back(edge);
  }
  requireConnected(data);
  data.planar = isPlanar(data);
  return data;
}

Adjacency adjacencyOf(const GraphData& data)
{
  Adjacency adjacency;
  adjacency.first.assign(data.size() + 1, 0);
  for (const GraphEdge& edge : data.edges)
  {
    ++adjacency.first[edge.from + 1];
    ++adjacency.first[edge.to + 1];
  }
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    adjacency.first[i + 1] += adjacency.first[i];
  }
  adjacency.edges.resize(2 * data.edges.size());
  std::vector<std::size_t> next(adjacency.first.begin(), adjacency.first.end() - 1);
  for (std::size_t e = 0; e < data.edges.size(); ++e)
  {
    adjacency.edges[next[data.edges[e].from]++] = e;
    adjacency.edges[next[data.edges[e].to]++] = e;
  }
  return adjacency;
}
}  // namespace dyslam
