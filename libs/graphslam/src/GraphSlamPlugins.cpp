// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/graphslam/FactorGraphOptimizer.h>
#include <dyslam/graphslam/GraphSlamPlugins.h>
#include <dyslam/graphslam/LoopEdgeDecider.h>
#include <dyslam/graphslam/OdometryNodeDecider.h>
#include <mrpt/graphslam/ERD/CEmptyERD.h>

namespace dyslam
{
namespace
{
template <typename Interface, typename Plugin>
std::unique_ptr<Interface> make(const std::shared_ptr<GraphSlamContext>& context)
{
  return std::make_unique<Plugin>(context);
}

std::unique_ptr<EdgeDecider> makeNoLoops(const std::shared_ptr<GraphSlamContext>& /*context*/)
{
  return std::make_unique<mrpt::graphslam::deciders::CEmptyERD<GraphSlamContext::Graph>>();
}
}  // namespace

std::vector<GraphSlamPlugin<NodeDecider>> nodeDeciders()
{
  return {
      {"OdometryNodeDecider", "keyframes by distance and turn, and the odometry between them",
       make<NodeDecider, OdometryNodeDecider>},
  };
}

std::vector<GraphSlamPlugin<EdgeDecider>> edgeDeciders()
{
  return {
      {"LoopEdgeDecider", "loops by distance and appearance, verified by registration",
       make<EdgeDecider, LoopEdgeDecider>},
      {"CEmptyERD", "MRPT's own: no loops", makeNoLoops},
  };
}

std::vector<GraphSlamPlugin<GraphOptimizer>> graphOptimizers()
{
  return {
      {"FactorGraphOptimizer", "the backend's factor graph of vehicle and objects, solved by Ceres",
       make<GraphOptimizer, FactorGraphOptimizer>},
  };
}
}  // namespace dyslam
