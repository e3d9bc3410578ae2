// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/odometry/LidarOdometry.h>
#include <dyslam/odometry/LocalMapRefinement.h>
#include <dyslam/odometry/Preprocessor.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/tracking/Detector.h>
#include <dyslam/tracking/Tracker.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <vector>

namespace dyslam
{
namespace
{
using mrpt::system::CTimeLoggerEntry;

constexpr double seen_within = 0.5;   // m, of a first motion that the segmenter found
constexpr double usual_period = 0.1;  // s, of a revolution, before the second scan tells it

struct OdometryOptions : Options
{
  std::string method = "constant_velocity";
  /** Among vehicles that all move alike nothing else tells a recording begun on the move. [m/s] */
  double start_speed = 0;
  void describe(OptionsVisitor& v) override
  {
    v.word("method", method, odometryMethods(), "motion between scans");
    v.real("start_speed", start_speed, -50, 100, "m/s ahead at the first scan, if known");
  }
};

/** With a known speed the first registration must not look far for another. */
RefineOptions startingFrom(const OdometryOptions& odometry, RefineOptions refine)
{
  constexpr double known_within = 0.3;  // m, of the first motion
  if (odometry.start_speed != 0)
  {
    refine.start_deviation = std::min(refine.start_deviation, known_within);
  }
  return refine;
}

/** The motion scaled to another length of time, at constant velocity. */
Pose scaledMotion(const Pose& motion, double factor)
{
  return expSE3(factor * logSE3(motion));
}
}  // namespace

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
        pool(options.threads),
        preprocessor(config.get<PreprocessOptions>("preprocess"), pool),
        segmenter(makeSegmenter(config, pool)),
        odometry_options(config.get<OdometryOptions>("odometry")),
        odometry(makeOdometry(odometry_options.method, config, pool)),
        refine_options(startingFrom(odometry_options, config.get<RefineOptions>("refine"))),
        refinement(refine_options, pool),
        detector(config.get<DetectorOptions>("detector")),
        tracker(config.get<TrackerOptions>("tracker")),
        backend(config.get<BackendOptions>("backend"),
                config.get<LoopCloserOptions>("loop"),
                config.get<BackendSolverOptions>("solver")),
        map(config.get<StaticMapOptions>("map"))
  {
    last_motion.translation().x() = odometry_options.start_speed * usual_period;
  }

  /** What the last motion says about this one. */
  [[nodiscard]] Pose predictedMotion(double dt) const
  {
    return dt > 0 ? scaledMotion(last_motion, dt / last_dt) : Pose::Identity();
  }

  /** Before any motion is known the segmenter may have found one, among movers too. */
  [[nodiscard]] Pose startingMotion(const Pose& prediction);
  void estimateMotion(Frame& frame, const Pose& prediction);
  void remember(const Frame& frame, double dt);

  mrpt::system::CTimeLogger& times;
  PipelineOptions options;
  ThreadPool pool;
  Preprocessor preprocessor;
  std::unique_ptr<MovingSegmenter> segmenter;
  OdometryOptions odometry_options;
  std::unique_ptr<LidarOdometry> odometry;
  RefineOptions refine_options;
  LocalMapRefinement refinement;
  Detector detector;
  Tracker tracker;
  Backend backend;
  StaticMap map;

  bool first = true;    //!< no scan yet
  bool second = false;  //!< one scan yet
  double last_stamp = 0;
  double last_dt = usual_period;
  Pose last_motion = Pose::Identity();
  Pose T_odom_last = Pose::Identity();
};

Pipeline::Pipeline(ConfigLoader& config, mrpt::system::CTimeLogger& times)
    : stages_(std::make_unique<Stages>(config, times))
{
}

Pipeline::~Pipeline() = default;

void Pipeline::process(Frame& frame)
{
  Stages& s = *stages_;
  const double dt = s.first ? 0 : frame.scan.stamp - s.last_stamp;
  const Pose prediction = s.predictedMotion(dt);
  {
    const CTimeLoggerEntry timed(s.times, "preprocess");
    // The first scan's motion is not known yet: refinement undoes it once the second one tells it.
    frame.cloud = s.preprocessor.prepare(frame.scan, prediction, s.first ? usual_period : dt);
  }
  if (!s.first && (!s.second || s.odometry_options.start_speed != 0))
  {
    frame.T_previous_predicted = prediction;
  }
  if (s.segmenter && !s.segmenter->needsPose())
  {
    const CTimeLoggerEntry timed(s.times, "dyseg");
    s.segmenter->segment(frame);
  }
  s.estimateMotion(frame, s.startingMotion(prediction));
  if (s.segmenter && s.segmenter->needsPose())
  {
    const CTimeLoggerEntry timed(s.times, "dyseg");
    s.segmenter->segment(frame);
  }
  if (s.options.tracking)
  {
    const CTimeLoggerEntry timed(s.times, "tracking");
    s.detector.detect(frame);
    s.tracker.update(frame);
  }
  {
    const CTimeLoggerEntry timed(s.times, "backend");
    s.backend.addFrame(frame);
  }
  if (s.options.mapping && frame.is_keyframe)
  {
    const CTimeLoggerEntry timed(s.times, "map");
    s.map.insert(frame);
  }
  s.remember(frame, dt);
}

Pose Pipeline::Stages::startingMotion(const Pose& prediction)
{
  if (!second || odometry_options.start_speed != 0 || !segmenter ||
      segmenter->staticMotion() == nullptr)
  {
    return prediction;
  }
  refinement.setStartDeviation(std::min(refine_options.start_deviation, seen_within));
  return segmenter->staticMotion()->T_previous_current;
}

void Pipeline::Stages::estimateMotion(Frame& frame, const Pose& prediction)
{
  {
    const CTimeLoggerEntry timed(times, "odometry");
    frame.odometry = odometry->process(frame, prediction);
    frame.static_confidence = odometry->staticConfidence();
  }
  const CTimeLoggerEntry timed(times, "refine");
  const Pose& motion = frame.odometry.converged ? frame.odometry.T_previous_current : prediction;
  const RefineResult result = refinement.refine(frame, T_odom_last * motion);
  frame.refined = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  if (refine_options.method == RefineMethod::none)
  {
    frame.refined = frame.odometry;
  }
}

void Pipeline::Stages::remember(const Frame& frame, double dt)
{
  if (dt > 0)
  {
    last_motion = T_odom_last.inverse() * frame.T_odom_vehicle;
    last_dt = dt;
  }
  second = first;
  first = false;
  last_stamp = frame.scan.stamp;
  T_odom_last = frame.T_odom_vehicle;
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
    std::vector<Pose> poses;
    for (const auto& keyframe : s.backend.keyframes())
    {
      poses.push_back(keyframe.T_map_vehicle);
    }
    s.map.rebuild(poses);
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

bool Pipeline::isReported(const TrackedObject& object) const
{
  return stages_->tracker.reported(object);
}

std::string Pipeline::summary() const
{
  const Stages& s = *stages_;
  std::string text = s.segmenter ? s.segmenter->name() + " + " : "";
  text += s.odometry->name();
  switch (s.refine_options.method)
  {
    case RefineMethod::none:
      break;
    case RefineMethod::point_to_plane:
      text += " + point_to_plane";
      break;
    case RefineMethod::gicp:
      text += " + gicp";
      break;
  }
  return text;
}
}  // namespace dyslam
