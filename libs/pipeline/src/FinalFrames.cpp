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
    hindsight_.emplace(labels, options_.threads);
  }
  if (labels.hindsight && options_.hindsight_tracking && options_.tracking && !has_given_boxes &&
      !config.get<BackendOptions>("backend").hasObjects())
  {
    tracking_again_.emplace(config, MovingLabels::hindsight);
  }
}

void FinalFrames::onFinal(std::function<void(Frame)> use, FrameParts parts)
{
  on_final_ = std::move(use);
  final_parts_ = std::max(parts, FrameParts::points);
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

void FinalFrames::handOn(Frame final_frame)
{
  if (tracking_again_)
  {
    const CTimeLoggerEntry timed(times_, "hindsight.tracking");
    final_frame.reported_before = pointsOfReported(final_frame);
    tracking_again_->update(final_frame);
  }
  insertInMap(final_frame);
  if (on_final_)
  {
    on_final_(std::move(final_frame));
  }
}

FrameParts FinalFrames::keptOf(const Frame& frame) const
{
  const FrameParts for_map =
      options_.mapping && frame.is_keyframe ? FrameParts::cloud : FrameParts::none;
  const FrameParts for_tracker = tracking_again_ ? FrameParts::points : FrameParts::none;
  const FrameParts for_user = on_final_ ? final_parts_ : FrameParts::none;
  return std::max({for_map, for_tracker, for_user});
}

void FinalFrames::finalise(const Frame& frame)
{
  if (!hindsight_)
  {
    insertInMap(frame);
    if (on_final_)
    {
      on_final_(copyOf(frame, keptOf(frame)));
    }
    return;
  }
  std::vector<Frame> final_frames;
  {
    const CTimeLoggerEntry timed(times_, "hindsight");
    hindsight_->add(frame, keptOf(frame), [&](Frame f) { final_frames.push_back(std::move(f)); });
  }
  for (Frame& f : final_frames)
  {
    handOn(std::move(f));
  }
}

void FinalFrames::finaliseFirst()
{
  if (first_)
  {
    finalise(*std::exchange(first_, std::nullopt));
  }
}

void FinalFrames::add(const Frame& frame)
{
  if (first_)
  {
    if (frame.motion.registered())
    {
      redeskew(frame.motion.T_previous_current, frame.dt, pool_, first_->cloud);
    }
    finaliseFirst();
  }
  if (frame.dt > 0)
  {
    finalise(frame);
  }
  else
  {
    first_ = frame;
  }
}

void FinalFrames::finish()
{
  finaliseFirst();
  if (hindsight_)
  {
    const CTimeLoggerEntry timed(times_, "hindsight.finish");
    // The estimation has ended: a frame is passed on while the next one is labelled.
    JobThread receiver;
    hindsight_->finish(
        [&](Frame frame)
        {
          receiver.add([this, final_frame = std::make_shared<Frame>(std::move(frame))]
                       { handOn(std::move(*final_frame)); });
        });
    receiver.finish();
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
  if (hindsight_)
  {
    archive(*hindsight_);
  }
  if (tracking_again_)
  {
    archive(*tracking_again_);
  }
}
}  // namespace dyslam
