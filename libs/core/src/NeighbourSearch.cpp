// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/NeighbourSearch.h>

#include <algorithm>
#include <numeric>

namespace dyslam
{
namespace
{
constexpr std::uint32_t leaf_size = 12;

bool nearer(const Neighbour& a, const Neighbour& b)
{
  return a.squared_distance < b.squared_distance ||
         (a.squared_distance == b.squared_distance && a.index < b.index);
}

/** Keeps the k nearest sorted: faster than a heap for usual k. */
struct KnnVisitor
{
  std::size_t k;
  float bound;
  std::vector<Neighbour>& best;

  void visit(const Neighbour& n)
  {
    if (best.size() == k)
    {
      if (!nearer(n, best.back()))
      {
        return;
      }
      best.pop_back();
    }
    best.push_back(n);
    std::size_t at = best.size() - 1;
    for (; at > 0 && nearer(n, best[at - 1]); --at)
    {
      best[at] = best[at - 1];
    }
    best[at] = n;
    if (best.size() == k)
    {
      bound = best.back().squared_distance;
    }
  }
};

struct NearestVisitor
{
  float bound;
  Neighbour best;
  bool found;

  void visit(const Neighbour& n)
  {
    if (!found || nearer(n, best))
    {
      best = n;
      found = true;
      bound = n.squared_distance;
    }
  }
};
}  // namespace

KdTree::KdTree(const std::vector<Eigen::Vector3f>& points)
{
  index_.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (points[i].allFinite())
    {
      index_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  points_ = points;
  const auto count = static_cast<std::uint32_t>(index_.size());
  if (count > 0)
  {
    nodes_.reserve(4 * count / leaf_size + 4);
    build(0, count);
  }
  // From input order to tree order.
  points_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i)
  {
    points_[i] = points[index_[i]];
  }
}

std::uint32_t KdTree::build(std::uint32_t begin, std::uint32_t end)
{
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({0, -1, begin, end});
  if (end - begin <= leaf_size)
  {
    return id;
  }
  Eigen::Vector3f low = points_[index_[begin]];
  Eigen::Vector3f high = low;
  for (std::uint32_t i = begin + 1; i < end; ++i)
  {
    low = low.cwiseMin(points_[index_[i]]);
    high = high.cwiseMax(points_[index_[i]]);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto less = [&](std::uint32_t a, std::uint32_t b)
  {
    const float pa = points_[a][axis];
    const float pb = points_[b][axis];
    return pa < pb || (pa == pb && a < b);
  };
  std::nth_element(index_.begin() + begin, index_.begin() + middle, index_.begin() + end, less);
  nodes_[id].axis = static_cast<std::int32_t>(axis);
  nodes_[id].split = points_[index_[middle]][axis];
  build(begin, middle);
  const std::uint32_t right = build(middle, end);
  nodes_[id].begin = right;
  return id;
}

template <typename Visitor>
void KdTree::search(std::uint32_t id, const Eigen::Vector3f& query, Visitor& visitor) const
{
  const Node& node = nodes_[id];
  if (node.axis < 0)
  {
    for (std::uint32_t i = node.begin; i < node.end; ++i)
    {
      const float d = (points_[i] - query).squaredNorm();
      if (d <= visitor.bound)
      {
        visitor.visit({index_[i], d});
      }
    }
    return;
  }
  const float offset = query[node.axis] - node.split;
  const std::uint32_t left = id + 1;
  const std::uint32_t right = node.begin;
  search(offset < 0 ? left : right, query, visitor);
  if (offset * offset <= visitor.bound)
  {
    search(offset < 0 ? right : left, query, visitor);
  }
}

void KdTree::nearest(const Eigen::Vector3f& query,
                     std::size_t k,
                     std::vector<Neighbour>& result,
                     float max_distance) const
{
  result.clear();
  if (points_.empty() || k == 0 || !query.allFinite())
  {
    return;
  }
  KnnVisitor visitor{k, max_distance * max_distance, result};
  search(0, query, visitor);
}

bool KdTree::nearest(const Eigen::Vector3f& query, Neighbour& result, float max_distance) const
{
  if (points_.empty() || !query.allFinite())
  {
    return false;
  }
  NearestVisitor visitor{max_distance * max_distance, {}, false};
  search(0, query, visitor);
  result = visitor.best;
  return visitor.found;
}
}  // namespace dyslam
