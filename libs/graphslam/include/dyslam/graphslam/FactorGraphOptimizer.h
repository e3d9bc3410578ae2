// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/graphslam/GraphSlamContext.h>
#include <mrpt/graphslam/interfaces/CGraphSlamOptimizer.h>

#include <memory>
#include <string>

namespace dyslam
{
/** Optimiser for mrpt::graphslam::CGraphSlamEngine: runs the backend's optimiser and writes its
 * result to the nodes of the engine's network. Works with OdometryNodeDecider on the same context.
 *
 * After a step with a new node the engine itself resets all nodes to the poses of the chained edges
 * (dijkstra_nodes_estimate()); the next step writes the optimised poses again. Call finish() after
 * the last observation, else the network may hold the poses of the chained edges.
 */
class FactorGraphOptimizer
    : public mrpt::graphslam::optimizers::CGraphSlamOptimizer<GraphSlamContext::Graph>
{
 public:
  explicit FactorGraphOptimizer(std::shared_ptr<GraphSlamContext> context);

  /** Optimises, if that is due after the frame of this step's observations, and writes the poses.
   */
  bool updateState(mrpt::obs::CActionCollection::Ptr action,
                   mrpt::obs::CSensoryFrame::Ptr observations,
                   mrpt::obs::CObservation::Ptr observation) override;

  /** Whether the last step moved keyframes. */
  [[nodiscard]] bool justFullyOptimizedGraph() const override { return moved_; }
  void getDescriptiveReport(std::string* report) const override;

  /** To be called after the last observation: GraphSlamContext::finish(); the network then holds
   * the nodes, edges and poses of the final result. */
  void finish();

 protected:
  void optimizeGraph() override;

 private:
  std::shared_ptr<GraphSlamContext> context_;
  bool reset_ = false;  //!< the engine has reset the nodes since the poses were written
  bool moved_ = false;  //!< the last step moved keyframes
};
}  // namespace dyslam
