// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/FrameCopy.h>
#include <dyslam/core/Parallel.h>
#include <dyslam/core/RuntimeModule.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/mapping/HindsightLabels.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/JobThread.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/tracking/Detector.h>
#include <dyslam/tracking/Tracker.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "GivenBoxes.h"

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
  if (segmentation.method == "network" || odometry.method == "dylo")
  {
    return loadRuntimeModuleAhead("networks");
  }
  return {};
}

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

struct Pipeline::Stages
{
  Stages(ConfigLoader& config,
         mrpt::system::CTimeLogger& time_logger,
         const std::string& temporary_folder)
      : times(time_logger),
        options(config.get<PipelineOptions>("pipeline")),
        front_end(options.threads, config, times),
        detector(config.get<DetectorOptions>("detector")),
        boxes(givenBoxes(config)),
        tracker(config.get<TrackerOptions>("tracker")),
        keyframes({config.get<MemoryOptions>("memory"), temporary_folder}),
        backend(
            {config.get<BackendOptions>("backend"), config.get<LoopCloserOptions>("loop"),
             config.get<ObjectGraphOptions>("objects"), config.get<FactorGraphOptions>("solver"),
             config.get<GnssOptions>("gnss"), config.get<GravityOptions>("gravity")},
            keyframes),
        map(config.get<StaticMapOptions>("map"), keyframes)
  {
    const auto labels = config.get<HindsightOptions>("labels");
    if (labels.hindsight)
    {
      hindsight.emplace(labels, options.threads);
    }
    if (labels.hindsight && options.hindsight_tracking && options.tracking && !boxes &&
        config.get<BackendOptions>("backend").mode < BackendMode::segmot)
    {
      tracker_again.emplace(config.get<TrackerOptions>("tracker"));
    }
  }

  void insertInMap(const Frame& final_frame);
  /** Tracks the objects of a final frame again, if this is on; passes it to map and on_final. */
  void handOn(Frame final_frame);
  /** Parts of a frame that are kept until it is final. */
  [[nodiscard]] FrameParts keptOf(const Frame& frame) const;
  /** Takes the next frame, and finalises frames whose moving points are final now. */
  void finalise(const Frame& frame);
  void finaliseFirst();

  mrpt::system::CTimeLogger& times;
  PipelineOptions options;
  FrontEnd front_end;
  ThreadPool pool{1};  //!< threads of the back end; the front end has its own
  Detector detector;
  std::optional<GivenBoxes> boxes;  //!< boxes used instead of the detector's
  Tracker tracker;
  KeyframeStore keyframes;
  Backend backend;
  std::optional<HindsightLabels> hindsight;
  std::optional<Tracker> tracker_again;  //!< tracker for final frames
  std::optional<Frame> first;            //!< first frame, until the second one's motion deskews it
  StaticMap map;
  std::function<void(Frame)> on_final;
  FrameParts final_parts = FrameParts::points;  //!< parts of final frames for on_final
};

void Pipeline::Stages::insertInMap(const Frame& final_frame)
{
  if (!options.mapping || !final_frame.is_keyframe)
  {
    return;
  }
  const CTimeLoggerEntry timed(times, "map");
  if (final_frame.motion.registered())
  {
    map.insert(final_frame);
  }
  else
  {
    map.insertWithoutPoints(final_frame);
  }
}

void Pipeline::Stages::handOn(Frame final_frame)
{
  if (tracker_again)
  {
    const CTimeLoggerEntry timed(times, "hindsight.tracking");
    final_frame.reported_before = pointsOfReported(final_frame);
    tracker_again->markPredicted(final_frame);
    detector.detect(final_frame);
    tracker_again->update(final_frame);
  }
  insertInMap(final_frame);
  if (on_final)
  {
    on_final(std::move(final_frame));
  }
}

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
  redeskew(frame.motion.T_previous_current, frame.dt, s.pool, frame.cloud);
}

void Pipeline::trackObjects(Frame& frame)
{
  Stages& s = *stages_;
  if (s.options.tracking)
  {
    const CTimeLoggerEntry timed(s.times, "tracking");
    if (s.boxes)
    {
      s.boxes->detect(frame);
    }
    else
    {
      s.tracker.markPredicted(frame);
      s.detector.detect(frame);
    }
    s.tracker.update(frame);
    if (s.boxes && !s.hindsight)
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

FrameParts Pipeline::Stages::keptOf(const Frame& frame) const
{
  const FrameParts for_map =
      options.mapping && frame.is_keyframe ? FrameParts::cloud : FrameParts::none;
  const FrameParts for_tracker = tracker_again ? FrameParts::points : FrameParts::none;
  const FrameParts for_user = on_final ? final_parts : FrameParts::none;
  return std::max({for_map, for_tracker, for_user});
}

void Pipeline::Stages::finalise(const Frame& frame)
{
  if (!hindsight)
  {
    insertInMap(frame);
    if (on_final)
    {
      on_final(copyOf(frame, keptOf(frame)));
    }
    return;
  }
  std::vector<Frame> final_frames;
  {
    const CTimeLoggerEntry timed(times, "hindsight");
    hindsight->add(frame, keptOf(frame), [&](Frame f) { final_frames.push_back(std::move(f)); });
  }
  for (Frame& f : final_frames)
  {
    handOn(std::move(f));
  }
}

void Pipeline::Stages::finaliseFirst()
{
  if (first)
  {
    finalise(*std::exchange(first, std::nullopt));
  }
}

void Pipeline::finaliseFrames(const Frame& frame)
{
  Stages& s = *stages_;
  if (s.first)
  {
    if (frame.motion.registered())
    {
      redeskew(frame.motion.T_previous_current, frame.dt, s.pool, s.first->cloud);
    }
    s.finaliseFirst();
  }
  if (frame.dt > 0)
  {
    s.finalise(frame);
  }
  else
  {
    s.first = frame;
  }
}

void Pipeline::onFinal(std::function<void(Frame)> use, FrameParts parts)
{
  stages_->on_final = std::move(use);
  stages_->final_parts = std::max(parts, FrameParts::points);
}

bool Pipeline::tracksWithHindsight() const
{
  return stages_->tracker_again.has_value();
}

void Pipeline::finish()
{
  Stages& s = *stages_;
  {
    const CTimeLoggerEntry timed(s.times, "backend.finish");
    s.backend.finish();
  }
  s.finaliseFirst();
  if (s.hindsight)
  {
    const CTimeLoggerEntry timed(s.times, "hindsight.finish");
    // The estimation has ended: a frame is passed on while the next one is labelled.
    JobThread receiver;
    s.hindsight->finish(
        [&](Frame frame)
        {
          receiver.add([&s, final_frame = std::make_shared<Frame>(std::move(frame))]
                       { s.handOn(std::move(*final_frame)); });
        });
    receiver.finish();
  }
  if (s.options.mapping)
  {
    const CTimeLoggerEntry timed(s.times, "map.finish");
    s.map.correct();
  }
}

void Pipeline::exchangeFrontEndState(StateArchive& archive)
{
  const CTimeLoggerEntry timed(stages_->times, "checkpoint.front_end");
  archive(stages_->front_end);
}

void Pipeline::exchangeBackEndState(StateArchive& archive)
{
  Stages& s = *stages_;
  archive(s.tracker, s.keyframes, s.backend, s.first, s.map);
  if (s.hindsight)
  {
    archive(*s.hindsight);
  }
  if (s.tracker_again)
  {
    archive(*s.tracker_again);
  }
}

const Backend& Pipeline::backend() const
{
  return stages_->backend;
}

const StaticMap* Pipeline::map() const
{
  return stages_->options.mapping ? &stages_->map : nullptr;
}

Trajectory Pipeline::trajectory() const
{
  return stages_->backend.optimizedTrajectory();
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
  if (const std::string& problem = stages_->keyframes.memory().file->problem(); !problem.empty())
  {
    result.push_back(problem);
  }
  return result;
}
}  // namespace dyslam
