// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectTracking.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/pipeline/Pipeline.h>

namespace dyslam
{
namespace
{
std::optional<GivenBoxes> givenBoxes(ConfigLoader& config)
{
  const auto options = config.get<GivenBoxesOptions>("boxes");
  const auto noise = config.get<DetectionNoiseOptions>("detection_noise");
  if (options.file.empty() && !options.calib.empty())
  {
    throw UserError("boxes.calib is of the boxes of boxes.file; give that, too");
  }
  if (!options.file.empty() && !config.get<PipelineOptions>("pipeline").tracking)
  {
    throw UserError("boxes.file: the boxes are tracked, but pipeline.tracking is false");
  }
  return options.file.empty() ? std::nullopt
                              : std::optional<GivenBoxes>(std::in_place, options, noise);
}
}  // namespace

ObjectTracking::ObjectTracking(ConfigLoader& config, MovingLabels labels)
    : detector_(config.get<DetectorOptions>("detector"), labels),
      boxes_(givenBoxes(config)),
      tracker_(config.get<TrackerOptions>("tracker"), labels)
{
}

void ObjectTracking::update(Frame& frame)
{
  if (boxes_)
  {
    boxes_->detect(frame);
  }
  else
  {
    tracker_.markPredicted(frame);
    detector_.detect(frame);
  }
  tracker_.update(frame);
}

void ObjectTracking::exchangeState(StateArchive& archive)
{
  archive(tracker_);
}
}  // namespace dyslam
