// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/graphslam/FactorGraphOptimizer.h>

#include <utility>

#include "Plugins.h"

namespace dyslam
{
FactorGraphOptimizer::FactorGraphOptimizer(std::shared_ptr<GraphSlamContext> context)
    : context_(std::move(context))
{
  setUp(*this, "FactorGraphOptimizer");
}

bool FactorGraphOptimizer::updateState(mrpt::obs::CActionCollection::Ptr /*action*/,
                                       mrpt::obs::CSensoryFrame::Ptr /*observations*/,
                                       mrpt::obs::CObservation::Ptr /*observation*/)
{
  moved_ = false;
  if (context_->frame() != nullptr)
  {
    optimizeGraph();
  }
  return true;
}

void FactorGraphOptimizer::optimizeGraph()
{
  moved_ = context_->optimise();
  if (moved_ || reset_)
  {
    const auto view = context_->view();
    for (auto& [id, node] : m_graph->nodes)
    {
      node = view.nodes.at(id);
    }
    if (moved_)
    {
      m_graph->edges = view.edges;  // the optimiser may have left out loops, or used them again
    }
  }
  reset_ = context_->frame()->is_keyframe;
}

void FactorGraphOptimizer::finish()
{
  context_->finish();
  *m_graph = context_->view();
}

void FactorGraphOptimizer::getDescriptiveReport(std::string* report) const
{
  CGraphSlamOptimizer::getDescriptiveReport(report);
  const OptimisationResult& last = context_->backend().lastOptimisation();
  *report += m_class_name + ": ";
  *report += last.reason.empty()
                 ? "nothing to optimise\n"
                 : "last optimisation of everything: chi2 " + std::to_string(last.initial_chi2) +
                       " to " + std::to_string(last.final_chi2) + " in " +
                       std::to_string(last.iterations) + " iterations (" + last.reason + ")\n";
  for (const std::string& warning : context_->backend().warnings())
  {
    *report += "warning: " + warning + "\n";
  }
}
}  // namespace dyslam
