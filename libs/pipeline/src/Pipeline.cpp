// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/odometry/LidarOdometry.h>
#include <dyslam/odometry/LocalMapRefinement.h>
#include <dyslam/odometry/MotionFilter.h>
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

constexpr double seen_deviation = 0.1;      // m, of the segmenter's static motion
constexpr double seen_turn = 0.005;         // rad
constexpr double seen_within = 0.3;         // m, to look for a first motion around what was seen
constexpr double odometry_deviation = 0.1;  // m, of a motion between scans
constexpr double odometry_turn = 0.02;      // rad
constexpr double farthest = 4;              // deviations, beyond which it is another one
constexpr double settled_deviation = 0.03;  // m, of a method's that knows the prediction
constexpr double settled_turn = 0.006;      // rad
constexpr double farthest_settled = 1;      // deviations
constexpr double known_deviation = 0.1;     // m, of a prediction that a segmenter may rely on
constexpr float looks_mobile = 0.2F;        // likelihood of staying, below which a point may go
constexpr double usual_period = 0.1;        // s, of a revolution, before the second scan tells it
constexpr double first_turn = 1;            // rad/s, of a recording's start at most

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

/** Information of a motion with these deviations. */
Matrix6 measuredWith(double deviation, double turn)
{
  Vector6 precision;
  precision.head<3>().setConstant(1 / (deviation * deviation));
  precision.tail<3>().setConstant(1 / (turn * turn));
  return precision.asDiagonal();
}

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
        motion(config.get<MotionFilterOptions>("motion")),
        detector(config.get<DetectorOptions>("detector")),
        tracker(config.get<TrackerOptions>("tracker")),
        backend(config.get<BackendOptions>("backend"),
                config.get<LoopCloserOptions>("loop"),
                config.get<BackendSolverOptions>("solver")),
        map(config.get<StaticMapOptions>("map"))
  {
    Vector6 velocity = Vector6::Zero();
    velocity.x() = odometry_options.start_speed;
    motion.start(velocity, refine_options.start_deviation / usual_period, first_turn);
  }

  /** The segmenter's own motion of the static world, as long as too little time has passed to see
   * anything else move: of what looks as if it stayed, it is not misled by traffic all around.
   * Null if there is none, or none to be believed. */
  [[nodiscard]] const MotionEstimate* staticMotion(double dt, const PosePrior& prior) const;
  /** A scan-to-scan method may follow the traffic around, and call the world moving. One that
   * weighs its motion against the prediction is heeded only where they agree: beyond that it tells
   * less than the prediction does. */
  [[nodiscard]] bool heeds(const Pose& T_odom_found, double dt, const PosePrior& prior) const;
  /** How often the first scans left open which motion is the world's. */
  void countVote();
  void estimateMotion(Frame& frame, double dt);
  /** As long as nothing can be seen to move, what looks as if it could does not count. */
  void weighByLooks(Frame& frame) const;
  void remember(const Frame& frame);

  mrpt::system::CTimeLogger& times;
  PipelineOptions options;
  ThreadPool pool;
  Preprocessor preprocessor;
  std::unique_ptr<MovingSegmenter> segmenter;
  OdometryOptions odometry_options;
  std::unique_ptr<LidarOdometry> odometry;
  RefineOptions refine_options;
  LocalMapRefinement refinement;
  MotionFilter motion;
  Detector detector;
  Tracker tracker;
  Backend backend;
  StaticMap map;

  int scans = 0;  //!< before the one at hand
  int votes = 0;  //!< motions of the static world that the segmenter told in a run's first scans
  int unclear_votes = 0;
  double last_stamp = 0;
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
  const double dt = s.scans == 0 ? 0 : frame.scan.stamp - s.last_stamp;
  const Pose prediction = s.motion.predict(dt);
  {
    const CTimeLoggerEntry timed(s.times, "preprocess");
    // The first scan's motion is not known yet: refinement undoes it once the second one tells it.
    frame.cloud = s.preprocessor.prepare(frame.scan, prediction, s.scans == 0 ? usual_period : dt);
  }
  const bool known =
      s.odometry_options.start_speed != 0 || s.motion.deviation(dt) < known_deviation;
  if (s.scans > 0 && known)
  {
    frame.T_previous_predicted = prediction;
  }
  if (s.segmenter && !s.segmenter->needsPose())
  {
    const CTimeLoggerEntry timed(s.times, "dyseg");
    s.segmenter->segment(frame);
    s.countVote();
  }
  s.estimateMotion(frame, dt);
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
  s.remember(frame);
}

const MotionEstimate* Pipeline::Stages::staticMotion(double dt, const PosePrior& prior) const
{
  // The first two scans are skewed alike, no motion being known yet; the third one is not.
  if (scans == 0 || scans == 2 || dt <= 0 || odometry_options.start_speed != 0 || !segmenter ||
      segmenter->staticLikelihood() == nullptr || segmenter->staticMotion() == nullptr)
  {
    return nullptr;
  }
  const MotionEstimate* seen = segmenter->staticMotion();
  const Pose T_odom_seen = T_odom_last * seen->T_previous_current;
  return prior.deviationsTo(T_odom_seen, seen_deviation, seen_turn) < farthest ? seen : nullptr;
}

void Pipeline::Stages::countVote()
{
  if (scans > 0 && segmenter->staticLikelihood() != nullptr)
  {
    ++votes;
    unclear_votes += segmenter->staticMotion() == nullptr ? 1 : 0;
  }
}

bool Pipeline::Stages::heeds(const Pose& T_odom_found, double dt, const PosePrior& prior) const
{
  return dt > 0 && odometry->joinsPrediction()
             ? prior.deviationsTo(T_odom_found, settled_deviation, settled_turn) < farthest_settled
             : prior.deviationsTo(T_odom_found, odometry_deviation, odometry_turn) < farthest;
}

void Pipeline::Stages::estimateMotion(Frame& frame, double dt)
{
  const bool refining = refine_options.method != RefineMethod::none;
  PosePrior prior{T_odom_last * motion.predict(dt), motion.information(dt)};
  Matrix6 seen_information = Matrix6::Zero();
  const MotionEstimate* seen = staticMotion(dt, prior);
  if (seen != nullptr)
  {
    seen_information = measuredWith(seen_deviation, seen_turn);
    // A segmenter that looks from above sees neither height nor tilt.
    seen_information.diagonal().segment<3>(2).setZero();
    prior.join(T_odom_last * seen->T_previous_current, seen_information);
  }
  const bool started = scans == 1 && seen != nullptr;
  if (started)
  {
    refinement.setStartDeviation(std::min(refine_options.start_deviation, seen_within));
  }
  const Pose prediction = T_odom_last.inverse() * prior.T_odom_vehicle;
  bool believable = false;
  {
    const CTimeLoggerEntry timed(times, "odometry");
    frame.odometry = odometry->process(frame, prediction, prior.information);
    const Pose T_odom_found = T_odom_last * frame.odometry.T_previous_current;
    believable =
        frame.odometry.converged && (!refining || (!started && heeds(T_odom_found, dt, prior)));
    frame.odometry_heeded = believable;
    frame.static_confidence = believable ? odometry->staticConfidence() : std::vector<float>();
    weighByLooks(frame);
  }
  const CTimeLoggerEntry timed(times, "refine");
  Pose guess = believable ? frame.odometry.T_previous_current : prediction;
  if (believable && refining && odometry->joinsPrediction())
  {
    // The surer the prediction, the less a network that may be drawn along by traffic tells.
    PosePrior joint = prior;
    joint.join(T_odom_last * guess, measuredWith(odometry_deviation, odometry_turn));
    guess = T_odom_last.inverse() * joint.T_odom_vehicle;
    if (scans == 1)
    {
      refinement.setStartDeviation(std::min(refine_options.start_deviation, odometry_deviation));
    }
  }
  const RefineResult result = refinement.refine(frame, T_odom_last * guess, &prior);
  frame.refined = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  if (!refining)
  {
    frame.refined = frame.odometry;
    if (odometry->joinsPrediction())
    {
      const Matrix6 measured = believable ? frame.odometry.information : Matrix6(Matrix6::Zero());
      motion.update(dt, guess, measured + seen_information);
    }
    else
    {
      motion.follow(dt, guess);
    }
    return;
  }
  motion.update(dt, result.motion.T_previous_current,
                result.measured_information + seen_information, result.prior_weight);
}

void Pipeline::Stages::weighByLooks(Frame& frame) const
{
  const auto* looks = segmenter ? segmenter->staticLikelihood() : nullptr;
  if (looks == nullptr || looks->size() != frame.cloud.size())
  {
    return;
  }
  auto& confidence = frame.static_confidence;
  confidence.resize(frame.cloud.size(), 1.0F);
  std::transform(looks->begin(), looks->end(), confidence.begin(), confidence.begin(),
                 [](float l, float c) { return l < looks_mobile ? 0.0F : c; });
}

void Pipeline::Stages::remember(const Frame& frame)
{
  ++scans;
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

std::vector<std::string> Pipeline::warnings() const
{
  const Stages& s = *stages_;
  std::vector<std::string> warnings;
  if (s.refine_options.method == RefineMethod::none &&
      s.odometry_options.method == "constant_velocity")
  {
    warnings.emplace_back(
        "nothing measures the motion: odometry.method=constant_velocity only predicts it, and "
        "refine.method is none; change one of them");
  }
  constexpr int fewest_votes = 4;
  if (s.odometry_options.start_speed == 0 && s.votes >= fewest_votes &&
      2 * s.unclear_votes >= s.votes)
  {
    warnings.emplace_back(
        "the first scans leave open how fast the recording begins; if its speed there is known, "
        "set "
        "odometry.start_speed");
  }
  return warnings;
}
}  // namespace dyslam
