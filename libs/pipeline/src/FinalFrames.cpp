// SPDX-License-Identifier: BSD-3-Clause
#include "FinalFrames.h"

#include <dyslam/backend/Backend.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/JobThread.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

namespace
{
/** Whether each point belongs to a reported object. */
std::vector<bool> pointsOfReported(const Frame& frame)
{
  std::vector<bool> reported(frame.cloud.size(), false);
  for (const TrackedObject& object : frame.objects)
  {
    if (object.reported)
    {
      for (const std::uint32_t i : frame.pointsOf(object))
      {
        reported[i] = true;
      }
    }
  }
  return reported;
}
}  // namespace

FinalFrames::FinalFrames(ConfigLoader& config,
                         bool has_given_boxes,
                         KeyframeStore& keyframes,
                         ThreadPool& pool,
                         mrpt::system::CTimeLogger& times)
    : options_(config.get<PipelineOptions>("pipeline")),
      pool_(pool),
      times_(times),
      map_(config.get<StaticMapOptions>("map"), keyframes)
{
  const auto labels = config.get<HindsightOptions>("labels");
  if (labels.hindsight)
  {
    hindsight_labels_.emplace(labels, options_.threads);
  }
  if (labels.hindsight && options_.hindsight_tracking && options_.tracking && !has_given_boxes &&
      !config.get<BackendOptions>("backend").hasObjects())
  {
    second_tracking_.emplace(config, MovingLabels::hindsight);
  }
}

void FinalFrames::onFinal(std::function<void(Frame)> receive, FrameParts parts)
{
  if (has_begun_)
  {
    throw std::logic_error("Pipeline::onFinal: the receiver is set after the first frame");
  }
  const bool is_wanted = parts != FrameParts::none;
  receiver_ = is_wanted ? std::move(receive) : nullptr;
  receiver_parts_ = parts;
}

void FinalFrames::add(const Frame& causal)
{
  has_begun_ = true;
  if (first_)
  {
    if (causal.motion.registered())
    {
      redeskew(causal.motion.T_previous_current, causal.dt, pool_, first_->cloud);
    }
    releaseFirst();
  }
  if (causal.dt > 0)
  {
    label(causal);
  }
  else
  {
    first_ = causal;
  }
}

void FinalFrames::releaseFirst()
{
  if (first_)
  {
    label(*std::exchange(first_, std::nullopt));
  }
}

void FinalFrames::label(const Frame& causal)
{
  if (!hindsight_labels_)  // then there is no second tracking either
  {
    insertInMap(causal);
    if (receiver_)
    {
      receiver_(copyOf(causal, neededParts(causal)));
    }
    return;
  }
  std::vector<Frame> labelled;
  {
    const CTimeLoggerEntry timed(times_, "hindsight");
    hindsight_labels_->add(causal, neededParts(causal),
                           [&](Frame frame) { labelled.push_back(std::move(frame)); });
  }
  for (Frame& frame : labelled)
  {
    complete(std::move(frame));
  }
}

FrameParts FinalFrames::neededParts(const Frame& frame) const
{
  const FrameParts for_tracking = second_tracking_ ? FrameParts::points : FrameParts::none;
  const FrameParts for_map =
      options_.mapping && frame.is_keyframe ? FrameParts::cloud : FrameParts::none;
  return std::max({for_tracking, for_map, receiver_parts_});
}

void FinalFrames::complete(Frame labelled)
{
  trackAgain(labelled);
  insertInMap(labelled);
  if (receiver_)
  {
    receiver_(std::move(labelled));
  }
}

void FinalFrames::trackAgain(Frame& labelled)
{
  if (second_tracking_)
  {
    const CTimeLoggerEntry timed(times_, "hindsight.tracking");
    labelled.reported_before = pointsOfReported(labelled);
    second_tracking_->update(labelled);
  }
}

void FinalFrames::insertInMap(const Frame& final_frame)
{
  if (!options_.mapping || !final_frame.is_keyframe)
  {
    return;
  }
  const CTimeLoggerEntry timed(times_, "map");
  if (final_frame.motion.registered())
  {
    map_.insert(final_frame);
  }
  else
  {
    map_.insertWithoutPoints(final_frame);
  }
}

void FinalFrames::finish()
{
  releaseFirst();
  if (hindsight_labels_)
  {
    const CTimeLoggerEntry timed(times_, "hindsight.finish");
    JobThread completing;  // completes a frame while the next one is labelled
    hindsight_labels_->finish(
        [&](Frame frame)
        {
          completing.add([this, labelled = std::make_shared<Frame>(std::move(frame))]
                         { complete(std::move(*labelled)); });
        });
    completing.finish();
  }
  if (options_.mapping)
  {
    const CTimeLoggerEntry timed(times_, "map.finish");
    map_.correct();
  }
}

void FinalFrames::exchangeState(StateArchive& archive)
{
  archive(first_, map_);
  if (hindsight_labels_)
  {
    archive(*hindsight_labels_);
  }
  if (second_tracking_)
  {
    archive(*second_tracking_);
  }
}
}  // namespace dyslam
