// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/odometry/ScanClock.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/Pipeline.h>
#include <mrpt/system/CTimeLogger.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "FinalFrames.h"
#include "GivenBoxes.h"
#include "ObjectTracking.h"
#include "PriorMapFile.h"

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

void PipelineOptions::describe(OptionsVisitor& v)
{
  v.integer("threads", threads, 0, 256,
            "threads of the parallel loops of all stages; 0: one per core");
  v.flag("tracking", tracking, "detect and track moving objects");
  v.flag("hindsight_tracking", hindsight_tracking,
         "detect and track objects again with the labels of labels.hindsight");
  v.flag("mapping", mapping, "build the static map");
}

std::future<void> loadAhead(const Config& config)
{
  MovingSegmenterOptions segmentation;
  OdometryOptions odometry;
  load(segmentation, config, "dyseg");
  load(odometry, config, "odometry");
  if (segmenterNeedsNetworks(segmentation.method) || scanMatcherNeedsNetworks(odometry.method))
  {
    return loadRuntimeModuleAhead("networks");
  }
  return {};
}

struct Pipeline::Stages
{
  Stages(ConfigLoader& config,
         mrpt::system::CTimeLogger& time_logger,
         const std::string& temporary_folder)
      : times(time_logger),
        options(config.get<PipelineOptions>("pipeline")),
        front_end(options.threads, config, times),
        tracking(config, MovingLabels::causal),
        keyframes({config.get<MemoryOptions>("memory"), temporary_folder}),
        backend(BackendConfig::load(config),
                keyframes,
                readPriorMap(config.get<PriorMapOptions>("prior_map"))),
        final_frames(config, tracking.hasGivenBoxes(), keyframes, pool, times)
  {
  }

  mrpt::system::CTimeLogger& times;
  PipelineOptions options;
  FrontEnd front_end;
  ThreadPool pool{1};  //!< threads of the back end; the front end has its own
  ObjectTracking tracking;
  KeyframeStore keyframes;
  Backend backend;
  FinalFrames final_frames;
};

Pipeline::Pipeline(ConfigLoader& config,
                   mrpt::system::CTimeLogger& times,
                   const std::string& temporary_folder,
                   const Layout& program)
{
  requireLibraryLayout(program);
  stages_ = std::make_unique<Stages>(config, times, temporary_folder);
}

Pipeline::~Pipeline() = default;

void Pipeline::process(Frame& frame)
{
  runFrontEnd(frame);
  runBackEnd(frame);
}

void Pipeline::runFrontEnd(Frame& frame, const Frame* next)
{
  stages_->front_end.process(frame, next);
}

void Pipeline::runBackEnd(Frame& frame)
{
  deskew(frame);
  trackObjects(frame);
  addOdometry(frame);
  addLoops(frame);
  optimise(frame);
  finaliseFrames(frame);
}

void Pipeline::deskew(Frame& frame)
{
  Stages& s = *stages_;
  const CTimeLoggerEntry timed(s.times, "deskew");
  // A prediction covers a part of a longer gap only.
  if (frame.motion.registered() || frame.dt <= ScanClock::max_extrapolation)
  {
    redeskew(frame.motion.T_previous_current, frame.dt, s.pool, frame.cloud);
  }
}

void Pipeline::trackObjects(Frame& frame)
{
  Stages& s = *stages_;
  if (s.options.tracking)
  {
    const CTimeLoggerEntry timed(s.times, "tracking");
    s.tracking.update(frame);
    if (s.tracking.hasGivenBoxes() && !s.final_frames.hasHindsightLabels())
    {
      GivenBoxes::markMoving(frame);
    }
  }
}

bool Pipeline::addOdometry(Frame& frame)
{
  const CTimeLoggerEntry timed(stages_->times, "backend");
  return stages_->backend.addOdometry(frame);
}

std::size_t Pipeline::addLoops(const Frame& frame)
{
  const CTimeLoggerEntry timed(stages_->times, "backend");
  return stages_->backend.addLoops(frame);
}

bool Pipeline::optimise(Frame& frame)
{
  const CTimeLoggerEntry timed(stages_->times, "backend");
  return stages_->backend.optimise(frame);
}

void Pipeline::finaliseFrames(const Frame& frame)
{
  stages_->final_frames.add(frame);
}

void Pipeline::onFinal(std::function<void(Frame)> receive, FrameParts parts)
{
  stages_->final_frames.onFinal(std::move(receive), parts);
}

bool Pipeline::hasSecondTracking() const
{
  return stages_->final_frames.hasSecondTracking();
}

void Pipeline::finish()
{
  Stages& s = *stages_;
  {
    const CTimeLoggerEntry timed(s.times, "backend.finish");
    s.backend.finish();
  }
  s.final_frames.finish();
}

void Pipeline::exchangeFrontEndState(StateArchive& archive)
{
  const CTimeLoggerEntry timed(stages_->times, "checkpoint.front_end");
  archive(stages_->front_end);
}

void Pipeline::exchangeBackEndState(StateArchive& archive)
{
  Stages& s = *stages_;
  archive(s.tracking, s.keyframes, s.backend, s.final_frames);
}

const Backend& Pipeline::backend() const
{
  return stages_->backend;
}

const StaticMap* Pipeline::map() const
{
  return stages_->final_frames.map();
}

Trajectory Pipeline::trajectory() const
{
  return stages_->backend.optimisedTrajectory();
}

FrontEndWaits Pipeline::frontEndWaits() const
{
  return stages_->front_end.waits();
}

std::string Pipeline::summary() const
{
  return stages_->front_end.summary();
}

std::vector<std::string> Pipeline::warnings() const
{
  std::vector<std::string> result = stages_->front_end.warnings();
  const std::vector<std::string> more = stages_->backend.warnings();
  result.insert(result.end(), more.begin(), more.end());
  const std::vector<std::string> of_boxes = stages_->tracking.warnings();
  result.insert(result.end(), of_boxes.begin(), of_boxes.end());
  if (const std::string& problem = stages_->keyframes.memory().file->problem(); !problem.empty())
  {
    result.push_back(problem);
  }
  return result;
}
}  // namespace dyslam
