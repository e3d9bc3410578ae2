// SPDX-License-Identifier: BSD-3-Clause
#include "Roads.h"

#include <cmath>

namespace dyslam::sim
{
void LaneNetwork::findConflicts()
{
  std::vector<std::vector<int>> turns(static_cast<std::size_t>(junctions));
  for (std::size_t i = 0; i < lanes.size(); ++i)
  {
    if (lanes[i].junction >= 0)
    {
      turns[static_cast<std::size_t>(lanes[i].junction)].push_back(static_cast<int>(i));
    }
  }
  const auto meet = [&](const Lane& a, const Lane& b)
  {
    if ((a.path.at(0).position - b.path.at(0).position).norm() < 0.5)
    {
      return false;  // turns from the same lane do not conflict
    }
    for (double s = 0; s <= a.path.length(); s += 0.7)
    {
      const Eigen::Vector2d p = a.path.at(s).position;
      for (double t = 0; t <= b.path.length(); t += 0.7)
      {
        if ((b.path.at(t).position - p).squaredNorm() < 2.9 * 2.9)
        {
          return true;
        }
      }
    }
    return false;
  };
  for (const auto& group : turns)
  {
    for (const int a : group)
    {
      for (const int b : group)
      {
        auto& lane = lanes[static_cast<std::size_t>(a)];
        if (a != b && meet(lane, lanes[static_cast<std::size_t>(b)]))
        {
          lane.conflicts.push_back(b);
        }
      }
    }
  }
}

int WalkNetwork::addNode(const Eigen::Vector2d& position)
{
  nodes.push_back(position);
  links_of_node.emplace_back();
  return static_cast<int>(nodes.size()) - 1;
}

void WalkNetwork::addLink(int a, int b, bool crossing, double width)
{
  const int link = static_cast<int>(links.size());
  links.push_back({a, b, crossing, width});
  links_of_node[static_cast<std::size_t>(a)].push_back(link);
  links_of_node[static_cast<std::size_t>(b)].push_back(link);
}
}  // namespace dyslam::sim
