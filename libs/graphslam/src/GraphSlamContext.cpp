// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Error.h>
#include <dyslam/graphslam/GraphSlamContext.h>
#include <dyslam/pipeline/Pipeline.h>

#include <stdexcept>
#include <utility>

namespace dyslam
{
GraphSlamContext::GraphSlamContext(Pipeline& pipeline,
                                   ScanDecoder decoder,
                                   std::size_t only_first_n,
                                   std::function<void(Frame)> on_frame)
    : pipeline_(pipeline),
      decoder_(std::move(decoder)),
      only_first_n_(only_first_n),
      on_frame_(std::move(on_frame))
{
}

void GraphSlamContext::beginStep()
{
  if (finished_)
  {
    throw std::logic_error("GraphSlamContext: an observation after finish()");
  }
  in_step_ = false;
}

void GraphSlamContext::takeObservation(const mrpt::obs::CObservation::Ptr& observation)
{
  if (done_)
  {
    return;
  }
  const auto scan = decoder_.take(observation);
  if (!scan)
  {
    return;
  }
  if (in_step_)
  {
    throw UserError("a sensory frame holds two scans of " + decoder_.sensorLabel() +
                    "; make it observations (rawlog-edit), each in a step of its own");
  }
  complete();
  done_ = only_first_n_ != 0 && scans_ >= only_first_n_;
  if (done_)
  {
    return;
  }
  Frame frame = decoder_.decode(*scan);
  pipeline_.runFrontEnd(frame);
  pipeline_.deskew(frame);
  pipeline_.trackObjects(frame);
  pipeline_.addOdometry(frame);
  T_map_vehicle_ = frame.T_map_vehicle();
  frame_ = std::move(frame);
  clock_shift_ = scan->clock_shift;
  in_step_ = true;
  ++scans_;
}

const Frame* GraphSlamContext::frame() const
{
  return in_step_ ? &*frame_ : nullptr;
}

std::size_t GraphSlamContext::addLoops()
{
  return pipeline_.addLoops(*frame_);
}

bool GraphSlamContext::optimise()
{
  const bool moved = pipeline_.optimise(*frame_);
  T_map_vehicle_ = frame_->T_map_vehicle();
  return moved;
}

/** Completes the frame. Called at the next scan, because the ground truth of a scan may follow the
 * scan. */
void GraphSlamContext::complete()
{
  std::optional<Frame> frame = std::exchange(frame_, std::nullopt);
  if (!frame)
  {
    return;
  }
  frame->T_world_vehicle_truth = decoder_.truthAt(frame->scan.stamp, clock_shift_);
  pipeline_.finaliseFrames(*frame);
  if (on_frame_)
  {
    on_frame_(std::move(*frame));
  }
}

void GraphSlamContext::finish()
{
  beginStep();
  complete();
  pipeline_.finish();
  finished_ = true;
}

GraphSlamContext::Graph GraphSlamContext::view() const
{
  return backend().graph();
}

const Backend& GraphSlamContext::backend() const
{
  return pipeline_.backend();
}
}  // namespace dyslam
