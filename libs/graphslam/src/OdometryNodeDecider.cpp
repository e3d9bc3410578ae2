// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/graphslam/OdometryNodeDecider.h>
#include <dyslam/mrpt/Conversions.h>
#include <dyslam/pipeline/Pipeline.h>

#include <utility>

#include "Plugins.h"

namespace dyslam
{
OdometryNodeDecider::OdometryNodeDecider(std::shared_ptr<GraphSlamContext> context)
    : context_(std::move(context))
{
  setUp(*this, "OdometryNodeDecider");
}

bool OdometryNodeDecider::updateState(mrpt::obs::CActionCollection::Ptr /*action*/,
                                      mrpt::obs::CSensoryFrame::Ptr observations,
                                      mrpt::obs::CObservation::Ptr observation)
{
  context_->beginStep();
  if (observation)
  {
    context_->takeObservation(observation);
  }
  else if (observations)
  {
    for (const auto& part : *observations)
    {
      context_->takeObservation(part);
    }
  }
  const Frame* frame = context_->frame();
  if (frame == nullptr)
  {
    return false;
  }
  const bool registers = frame->is_keyframe && context_->backend().keyframes().size() > 1;
  if (registers)
  {
    registerKeyframe();
  }
  return registers;
}

void OdometryNodeDecider::registerKeyframe()
{
  const auto view = context_->view();
  const mrpt::graphs::TNodeID id = context_->backend().keyframes().size() - 1;
  registerNewNodeAtEnd(view.edges.find({id - 1, id})->second);
  // At the first registration the base class has put the root where the vehicle is now.
  m_graph->nodes[id] = view.nodes.at(id);
  if (id == 1)
  {
    m_graph->nodes[0] = view.nodes.at(0);
  }
}

OdometryNodeDecider::global_pose_t OdometryNodeDecider::getCurrentRobotPosEstimation() const
{
  return global_pose_t(toMrpt(context_->vehicle()));
}

void OdometryNodeDecider::getDescriptiveReport(std::string* report) const
{
  CNodeRegistrationDecider::getDescriptiveReport(report);
  *report += m_class_name + ": " + context_->pipeline().summary() + "\n" +
             std::to_string(context_->backend().keyframes().size()) + " keyframes\n";
}
}  // namespace dyslam
