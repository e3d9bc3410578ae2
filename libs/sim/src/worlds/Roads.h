// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "Path.h"

namespace dyslam::sim
{
/** A lane, in world coordinates. */
struct Lane
{
  Path path;
  std::vector<int> next;       //!< successors; turns, if the lane ends at a junction
  int junction = -1;           //!< junction that a turn crosses; -1 for other lanes
  int axis = 0;                //!< of a turn: which of the two crossing streets it comes from
  std::vector<int> conflicts;  //!< turns that must not be used at the same time as this turn
  double speed_limit = 14;     //!< speed limit [m/s]
};

struct LaneNetwork
{
  std::vector<Lane> lanes;
  int junctions = 0;
  std::vector<double> light_cycles;  //!< by junction: period of its traffic lights, 0 for none [s];
                                     //!< empty: there are no lights
  std::vector<int> ego_route;        //!< closed sequence of lanes

  /** Computes the turns' conflicts from their geometry. */
  void findConflicts();
};

/** Paths of pedestrians and cyclists: straight links between nodes, in world coordinates. */
struct WalkNetwork
{
  struct Link
  {
    int a = 0, b = 0;
    bool crossing = false;  //!< crosses a carriageway; pedestrians wait for vehicles
    double width = 2;       //!< lateral extent [m]
  };
  std::vector<Eigen::Vector2d> nodes;
  std::vector<Link> links;
  std::vector<std::vector<int>> links_of_node;

  int addNode(const Eigen::Vector2d& position);
  void addLink(int a, int b, bool crossing, double width);
};
}  // namespace dyslam::sim
