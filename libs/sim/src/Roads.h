// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "Path.h"

namespace dyslam::sim
{
/** A piece of carriageway for one row of vehicles, in world coordinates. */
struct Lane
{
  Path path;
  std::vector<int>
      next;  //!< lanes that follow; a lane that ends at a junction is followed by its turns
  int junction = -1;  //!< of a turn: the junction it crosses
  std::vector<int>
      conflicts;            //!< of a turn: other turns that must not be under way at the same time
  double speed_limit = 14;  //!< [m/s]
};

struct LaneNetwork
{
  std::vector<Lane> lanes;
  int junctions = 0;
  std::vector<int> ego_route;  //!< closed sequence of lanes

  /** Fills the turns' conflicts from their geometry. */
  void findConflicts();
};

/** Where people walk or ride: straight links between nodes, in world coordinates. */
struct WalkNetwork
{
  struct Link
  {
    int a = 0, b = 0;
    bool crossing = false;  //!< over a carriageway: look before you walk
    double width = 2;       //!< people keep within this [m]
  };
  std::vector<Eigen::Vector2d> nodes;
  std::vector<Link> links;
  std::vector<std::vector<int>> links_of_node;

  int addNode(const Eigen::Vector2d& position);
  void addLink(int a, int b, bool crossing, double width);
};
}  // namespace dyslam::sim
