// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/graphslam/GraphSlamContext.h>
#include <mrpt/graphslam/interfaces/CEdgeRegistrationDecider.h>

#include <map>
#include <memory>
#include <string>

namespace dyslam
{
/** Edge registration for mrpt::graphslam::CGraphSlamEngine: the loops that the backend accepts.
 * Works with OdometryNodeDecider on the same context. */
class LoopEdgeDecider
    : public mrpt::graphslam::deciders::CEdgeRegistrationDecider<GraphSlamContext::Graph>
{
 public:
  explicit LoopEdgeDecider(std::shared_ptr<GraphSlamContext> context);

  /** Searches for loops of the frame that the node decider has made of this step's observations. */
  bool updateState(mrpt::obs::CActionCollection::Ptr action,
                   mrpt::obs::CSensoryFrame::Ptr observations,
                   mrpt::obs::CObservation::Ptr observation) override;

  /** "ICP3D" and "LC", the engine's names: both are the number of loops. */
  void getEdgesStats(std::map<std::string, int>* edge_type_to_num) const override;
  void getDescriptiveReport(std::string* report) const override;

 protected:
  void registerNewEdge(const mrpt::graphs::TNodeID& from,
                       const mrpt::graphs::TNodeID& to,
                       const constraint_t& edge) override;

 private:
  void registerLoops();

  std::shared_ptr<GraphSlamContext> context_;
  std::size_t seen_ = 0;  //!< number of Backend::loops() registered so far
};
}  // namespace dyslam
