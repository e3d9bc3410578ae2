// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/graphslam/LoopEdgeDecider.h>

#include <algorithm>
#include <utility>

#include "Plugins.h"

namespace dyslam
{
namespace
{
std::size_t countOf(const std::vector<Loop>& loops, LoopVerdict verdict)
{
  return static_cast<std::size_t>(std::count_if(
      loops.begin(), loops.end(), [verdict](const Loop& l) { return l.verdict == verdict; }));
}
}  // namespace

LoopEdgeDecider::LoopEdgeDecider(std::shared_ptr<GraphSlamContext> context)
    : context_(std::move(context))
{
  setUp(*this, "LoopEdgeDecider");
}

bool LoopEdgeDecider::updateState(mrpt::obs::CActionCollection::Ptr /*action*/,
                                  mrpt::obs::CSensoryFrame::Ptr /*observations*/,
                                  mrpt::obs::CObservation::Ptr /*observation*/)
{
  m_just_inserted_lc = context_->frame() != nullptr && context_->addLoops() > 0;
  if (m_just_inserted_lc)
  {
    registerLoops();
  }
  return true;
}

void LoopEdgeDecider::registerLoops()
{
  const auto view = context_->view();
  const std::vector<Loop>& loops = context_->backend().loops();
  for (; seen_ < loops.size(); ++seen_)
  {
    const Loop& loop = loops[seen_];
    const auto edge = view.edges.find({loop.from, loop.to});
    if (loop.verdict == LoopVerdict::accepted && edge != view.edges.end())
    {
      registerNewEdge(loop.from, loop.to, edge->second);
    }
  }
}

void LoopEdgeDecider::registerNewEdge(const mrpt::graphs::TNodeID& from,
                                      const mrpt::graphs::TNodeID& to,
                                      const constraint_t& edge)
{
  CEdgeRegistrationDecider::registerNewEdge(from, to, edge);  // logs the edge
  m_graph->insertEdge(from, to, edge);
}

void LoopEdgeDecider::getEdgesStats(std::map<std::string, int>* edge_type_to_num) const
{
  const auto loops = static_cast<int>(context_->backend().factorGraph().usedLoops().size());
  (*edge_type_to_num)["ICP3D"] = loops;
  (*edge_type_to_num)["LC"] = loops;
}

void LoopEdgeDecider::getDescriptiveReport(std::string* report) const
{
  CEdgeRegistrationDecider::getDescriptiveReport(report);
  *report += m_class_name + ": loop candidates by decision\n";
  const std::vector<Loop>& loops = context_->backend().loops();
  for (const LoopVerdict verdict : loop_verdicts)
  {
    *report += toString(verdict) + ": " + std::to_string(countOf(loops, verdict)) + "\n";
  }
}
}  // namespace dyslam
