// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/dyseg/TemporalFilter.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/tracking/Detector.h>
#include <dyslam/tracking/Tracker.h>
#include <mrpt/system/CTimeLogger.h>

#include <vector>

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

void PipelineOptions::describe(OptionsVisitor& v)
{
  v.integer("threads", threads, 0, 256, "threads of the stages' loops; 0: all cores");
  v.flag("tracking", tracking, "detect and track moving objects");
  v.flag("mapping", mapping, "build the static map");
}

struct Pipeline::Stages
{
  Stages(ConfigLoader& config, mrpt::system::CTimeLogger& time_logger)
      : times(time_logger),
        options(config.get<PipelineOptions>("pipeline")),
        segmentation(config.get<MovingSegmenterOptions>("dyseg")),
        pool(options.threads),
        preprocessor(config.get<PreprocessOptions>("preprocess"), pool),
        segmenter(makeSegmenter(segmentation.method, config, pool)),
        filter(config.get<TemporalFilterOptions>("dyseg_filter")),
        odometry(config, pool, times),
        detector(config.get<DetectorOptions>("detector")),
        tracker(config.get<TrackerOptions>("tracker")),
        backend({config.get<BackendOptions>("backend"), config.get<LoopCloserOptions>("loop"),
                 config.get<ObjectGraphOptions>("objects"),
                 config.get<FactorGraphOptions>("solver")},
                keyframes),
        map(config.get<StaticMapOptions>("map"), keyframes)
  {
  }

  void preprocess(Frame& frame);
  /** Segments now if the segmenter runs before (false) or after (true) the pose is known. */
  void segment(Frame& frame, bool pose_known);
  void filterOverTime(Frame& frame);
  void track(Frame& frame);
  void optimize(Frame& frame);
  void insertIntoMap(const Frame& frame);

  mrpt::system::CTimeLogger& times;
  PipelineOptions options;
  MovingSegmenterOptions segmentation;
  ThreadPool pool;
  Preprocessor preprocessor;
  std::unique_ptr<MovingSegmenter> segmenter;  //!< null: nothing is segmented
  TemporalFilter filter;
  Odometry odometry;
  Detector detector;
  Tracker tracker;
  KeyframeStore keyframes;
  Backend backend;
  StaticMap map;
};

Pipeline::Pipeline(ConfigLoader& config, mrpt::system::CTimeLogger& times)
    : stages_(std::make_unique<Stages>(config, times))
{
}

Pipeline::~Pipeline() = default;

void Pipeline::process(Frame& frame)
{
  Stages& s = *stages_;
  s.odometry.predict(frame);
  s.preprocess(frame);
  s.segment(frame, false);
  s.odometry.estimate(frame);
  s.segment(frame, true);
  s.filterOverTime(frame);
  decideMoving(frame, s.segmentation.moving_threshold);
  s.odometry.integrate(frame);
  s.track(frame);
  s.optimize(frame);
  s.insertIntoMap(frame);
}

void Pipeline::finish()
{
  Stages& s = *stages_;
  {
    const CTimeLoggerEntry timed(s.times, "backend.finish");
    s.backend.finish();
  }
  if (s.options.mapping)
  {
    const CTimeLoggerEntry timed(s.times, "map.finish");
    s.map.correct();
  }
}

void Pipeline::Stages::preprocess(Frame& frame)
{
  const CTimeLoggerEntry timed(times, "preprocess");
  frame.cloud = preprocessor.prepare(frame.scan, frame.prior.T_previous_current, frame.dt);
}

void Pipeline::Stages::segment(Frame& frame, bool pose_known)
{
  if (segmenter && segmenter->needsPose() == pose_known)
  {
    const CTimeLoggerEntry timed(times, "dyseg");
    segmenter->segment(frame);
  }
}

void Pipeline::Stages::filterOverTime(Frame& frame)
{
  if (segmentation.filter)
  {
    const CTimeLoggerEntry timed(times, "dyseg");
    filter.apply(frame);
  }
}

void Pipeline::Stages::track(Frame& frame)
{
  if (options.tracking)
  {
    const CTimeLoggerEntry timed(times, "tracking");
    detector.detect(frame);
    tracker.update(frame);
  }
}

void Pipeline::Stages::optimize(Frame& frame)
{
  const CTimeLoggerEntry timed(times, "backend");
  backend.addFrame(frame);
}

void Pipeline::Stages::insertIntoMap(const Frame& frame)
{
  if (options.mapping && frame.is_keyframe)
  {
    const CTimeLoggerEntry timed(times, "map");
    map.insert(frame);
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

std::string Pipeline::summary() const
{
  const Stages& s = *stages_;
  std::string text = s.segmenter ? s.segmenter->name() + " + " : "";
  text += s.segmenter && s.segmentation.filter ? "filter + " : "";
  return text + s.odometry.name();
}

std::vector<std::string> Pipeline::warnings() const
{
  return stages_->odometry.warnings();
}
}  // namespace dyslam
