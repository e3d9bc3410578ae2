// SPDX-License-Identifier: BSD-3-Clause
#include "InitialGuess.h"

#include <dyslam/base/Error.h>

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <vector>

namespace dyslam
{
namespace
{
using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;

/** First column of each node's unknowns: `width` columns per node except the root. */
class Columns
{
 public:
  Columns(const GraphData& data, Eigen::Index width) : root_(data.root), width_(width) {}
  [[nodiscard]] Eigen::Index of(std::size_t node) const
  {
    return width_ * static_cast<Eigen::Index>(node < root_ ? node : node - 1);
  }

 private:
  std::size_t root_;
  Eigen::Index width_;
};

Eigen::MatrixXd solveSymmetric(Eigen::Index size, const Triplets& lower, const Eigen::MatrixXd& rhs)
{
  Sparse H(size, size);
  H.setFromTriplets(lower.begin(), lower.end());
  const Eigen::SimplicialLLT<Sparse, Eigen::Lower> cholesky(H);
  if (cholesky.info() != Eigen::Success)
  {
    throw UserError(
        "pose graph: the chordal initialisation fails, as the information of the edges is too "
        "uneven; set pose_graph.start=file");
  }
  return cholesky.solve(rhs);
}

void addBlock(Triplets& lower, Eigen::Index row, Eigen::Index col, const Eigen::Matrix3d& block)
{
  for (Eigen::Index r = 0; r < 3; ++r)
  {
    for (Eigen::Index c = 0; c < 3; ++c)
    {
      if (row + r >= col + c)
      {
        lower.emplace_back(row + r, col + c, block(r, c));
      }
    }
  }
}

Eigen::Matrix3d nearestRotation(const Eigen::Matrix3d& m)
{
  Pose pose = Pose::Identity();
  pose.linear() = m;
  return orthonormalised(pose).linear();
}

/** Rows of all rotations, R_i Z = R_j in the least-squares sense: the three rows of a rotation
 * share one system, with one right-hand side each. */
void chordalRotations(GraphData& data)
{
  const Columns columns(data, 3);
  const auto size = static_cast<Eigen::Index>(3 * (data.size() - 1));
  Triplets lower;
  lower.reserve(data.edges.size() * 9 + data.size() * 9);
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(size, 3);
  std::vector<double> diagonal(data.size(), 0);
  const Eigen::Matrix3d root = data.poses[data.root].linear();
  for (const GraphEdge& edge : data.edges)
  {
    const double weight = edge.information.diagonal().tail<3>().mean();
    const Eigen::Matrix3d Z = weight * edge.T_from_to.linear();
    diagonal[edge.from] += weight;
    diagonal[edge.to] += weight;
    if (edge.from == data.root)
    {
      rhs.middleRows<3>(columns.of(edge.to)) += Z.transpose() * root.transpose();
    }
    else if (edge.to == data.root)
    {
      rhs.middleRows<3>(columns.of(edge.from)) += Z * root.transpose();
    }
    else if (edge.from > edge.to)
    {
      addBlock(lower, columns.of(edge.from), columns.of(edge.to), -Z);
    }
    else
    {
      addBlock(lower, columns.of(edge.to), columns.of(edge.from), -Z.transpose());
    }
  }
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      addBlock(lower, columns.of(i), columns.of(i), diagonal[i] * Eigen::Matrix3d::Identity());
    }
  }
  const Eigen::MatrixXd rows = solveSymmetric(size, lower, rhs);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      data.poses[i].linear() = nearestRotation(rows.middleRows<3>(columns.of(i)).transpose());
    }
  }
}

void chordalTranslations(GraphData& data)
{
  const Columns columns(data, 1);
  const auto size = static_cast<Eigen::Index>(data.size() - 1);
  Triplets lower;
  lower.reserve(data.edges.size() + data.size());
  Eigen::MatrixXd rhs = Eigen::MatrixXd::Zero(size, 3);
  std::vector<double> diagonal(data.size(), 0);
  for (const GraphEdge& edge : data.edges)
  {
    const double weight = edge.information.diagonal().head<3>().mean();
    const Eigen::RowVector3d step =
        weight * (data.poses[edge.from].linear() * edge.T_from_to.translation()).transpose();
    diagonal[edge.from] += weight;
    diagonal[edge.to] += weight;
    const Eigen::RowVector3d root = weight * data.poses[data.root].translation().transpose();
    if (edge.from != data.root)
    {
      rhs.row(columns.of(edge.from)) -= step;
      rhs.row(columns.of(edge.from)) += edge.to == data.root ? root : Eigen::RowVector3d::Zero();
    }
    if (edge.to != data.root)
    {
      rhs.row(columns.of(edge.to)) += step;
      rhs.row(columns.of(edge.to)) += edge.from == data.root ? root : Eigen::RowVector3d::Zero();
    }
    if (edge.from != data.root && edge.to != data.root)
    {
      lower.emplace_back(columns.of(std::max(edge.from, edge.to)),
                         columns.of(std::min(edge.from, edge.to)), -weight);
    }
  }
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      lower.emplace_back(columns.of(i), columns.of(i), diagonal[i]);
    }
  }
  const Eigen::MatrixXd translations = solveSymmetric(size, lower, rhs);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (i != data.root)
    {
      data.poses[i].translation() = translations.row(columns.of(i)).transpose();
    }
  }
}
}  // namespace

void completePoses(GraphData& data)
{
  const Adjacency adjacency = adjacencyOf(data);
  std::vector<std::size_t> queue = {data.root};
  data.has_pose[data.root] = true;
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    if (data.has_pose[i] && i != data.root)
    {
      queue.push_back(i);
    }
  }
  for (std::size_t head = 0; head < queue.size(); ++head)
  {
    const std::size_t node = queue[head];
    for (std::size_t k = adjacency.first[node]; k < adjacency.first[node + 1]; ++k)
    {
      const GraphEdge& edge = data.edges[adjacency.edges[k]];
      const bool forward = edge.from == node;
      const std::size_t other = forward ? edge.to : edge.from;
      if (!data.has_pose[other])
      {
        data.poses[other] =
            data.poses[node] * (forward ? edge.T_from_to : edge.T_from_to.inverse());
        data.has_pose[other] = true;
        queue.push_back(other);
      }
    }
  }
}

void chordalPoses(GraphData& data)
{
  data.has_pose.assign(data.size(), true);
  if (data.size() > 1)
  {
    chordalRotations(data);
    chordalTranslations(data);
  }
}
}  // namespace dyslam
