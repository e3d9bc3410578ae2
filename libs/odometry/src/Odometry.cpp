// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "FrameContext.h"
#include "matchers/CloudCheck.h"
#include "motion/IntervalResolver.h"
#include "motion/MotionGate.h"
#include "motion/MotionPredictor.h"
#include "motion/MotionUncertainty.h"

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

namespace
{
/** What the steps of a frame need of the frames before. Saved as a whole. */
struct OdometryHistory
{
  Pose T_odom_previous = Pose::Identity();  //!< pose of the vehicle at the previous scan
  /** Motion during the previous sweep that its cloud was deskewed with. */
  Pose T_sweep_previous = Pose::Identity();
  double time_without_scan = 0;  //!< time between the last usable and the previous scan [s]
  bool registered = false;       //!< a scan has been registered to the map
  int segmenter_frames = 0;      //!< number of frames with an appearance prior
  int segmenter_failures = 0;    //!< number of those in which the segmenter found no ego-motion
  int registered_scans = 0;      //!< number of scans registered to a map
  int degenerate_scans = 0;      //!< number of those that do not determine all of the motion
};

/** The gyroscope can be checked by registered scans only. */
MotionSensorOptions sensorOptions(ConfigLoader& config, bool registers)
{
  auto options = config.get<MotionSensorOptions>("motion_sensors");
  options.gyroscope_check = options.gyroscope_check && registers;
  return options;
}

/** Until motion can be observed, points of movable appearance have zero weight.
 * \param min_static_prior static probability below which the appearance counts as movable */
void weightByAppearance(double min_static_prior, Frame& frame)
{
  if (frame.static_prior.empty() || frame.static_prior.size() != frame.cloud.size())
  {
    return;
  }
  const auto least = static_cast<float>(min_static_prior);
  frame.static_confidence.resize(frame.cloud.size(), 1.0F);
  std::transform(frame.static_prior.begin(), frame.static_prior.end(),
                 frame.static_confidence.begin(), frame.static_confidence.begin(),
                 [least](float prior, float confidence)
                 { return prior < least ? 0.0F : confidence; });
}
}  // namespace

/** The parts of the odometry, and the steps of estimate(). */
struct Odometry::State
{
  /** \param given the scan matcher; null for the one that the config names */
  State(ConfigLoader& config,
        ThreadPool& pool,
        mrpt::system::CTimeLogger& time_logger,
        std::unique_ptr<ScanMatcher> given);

  [[nodiscard]] bool registers() const { return refine.method != RefineMethod::none; }

  void fuseSegmenterMotion(Frame& frame, FrameContext& context);
  void matchScan(Frame& frame, FrameContext& context);
  void registerToMap(Frame& frame, FrameContext& context, const Pose& T_guess);
  [[nodiscard]] LocalMapRegistration::Alignment registerFrom(const Pose& T_guess,
                                                             Frame& frame,
                                                             FrameContext& context);
  void takeMatcherMotion(Frame& frame, const FrameContext& context, const Pose& T_guess);

  void exchangeState(StateArchive& archive)
  {
    archive(predictor, *matcher, registration, uncertainty, history);
  }

  mrpt::system::CTimeLogger& times;
  // Options, in the order of the sections in the effective config
  OdometryOptions options;
  FusionOptions fusion;
  MotionFilterOptions motion;
  RefineOptions refine;
  // Saved
  std::unique_ptr<ScanMatcher> matcher;
  LocalMapRegistration registration;
  MotionPredictor predictor;
  MotionUncertainty uncertainty;
  OdometryHistory history;
  // Not saved
  MotionGate gate{fusion, registers()};
  IntervalResolver resolver{predictor, registration};
  FrameContext current;  //!< context of the frame that predict() was called with last
  LocalMapRegistration::Alignment alignment;  //!< alignment of that frame, until integrate()
};

Odometry::State::State(ConfigLoader& config,
                       ThreadPool& pool,
                       mrpt::system::CTimeLogger& time_logger,
                       std::unique_ptr<ScanMatcher> given)
    : times(time_logger),
      options(config.get<OdometryOptions>("odometry")),
      fusion(config.get<FusionOptions>("fusion")),
      motion(config.get<MotionFilterOptions>("motion")),
      refine(config.get<RefineOptions>("refine")),
      matcher(given ? std::move(given) : makeScanMatcher(options.method, config, pool)),
      registration(refine, pool),
      predictor(options, motion, sensorOptions(config, registers()), fusion.reliable_prior_sigma),
      uncertainty(config.get<UncertaintyOptions>("uncertainty"))
{
}

Odometry::Odometry(ConfigLoader& config, ThreadPool& pool, mrpt::system::CTimeLogger& times)
    : Odometry(config, pool, times, nullptr)
{
}
Odometry::Odometry(ConfigLoader& config,
                   ThreadPool& pool,
                   mrpt::system::CTimeLogger& times,
                   std::unique_ptr<ScanMatcher> matcher)
    : state_(std::make_unique<State>(config, pool, times, std::move(matcher)))
{
}
Odometry::~Odometry() = default;
Odometry::Odometry(Odometry&&) noexcept = default;

void Odometry::predict(Frame& frame)
{
  State& s = *state_;
  s.current = FrameContext();
  s.predictor.predict(frame, s.current);
  frame.T_odom_vehicle = s.history.T_odom_previous * frame.prior.T_previous_current;
}

void Odometry::resolveInterval(Frame& frame, const PrepareCloud& prepare)
{
  State& s = *state_;
  if (!s.current.interval_doubtful)
  {
    s.predictor.acceptInterval();
    return;
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  s.resolver.resolve(s.history.T_odom_previous, prepare, frame, s.current);
}

void Odometry::estimate(Frame& frame)
{
  State& s = *state_;
  FrameContext& context = s.current;
  {
    const CTimeLoggerEntry timed(s.times, "odometry");
    s.fuseSegmenterMotion(frame, context);
    s.matchScan(frame, context);
    weightByAppearance(s.fusion.min_static_prior, frame);
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  const bool usable = reasonUnusable(frame).empty();
  if (!usable && context.sensed_information(3, 3) <= 0)
  {
    // The gyroscope was not checked yet; nothing else measures the rotation.
    if (auto other = s.predictor.priorOtherwise(frame, context, context.sensed_information))
    {
      frame.prior = *other;
    }
  }
  context.time_without_scan = s.history.time_without_scan + frame.dt;
  const Pose T_guess = usable || context.canExtrapolate()
                           ? s.gate.initialGuess(frame, context)
                           : context.sensedPart(frame.prior.T_previous_current, Vector6::Zero());
  if (s.registers())
  {
    s.registerToMap(frame, context, T_guess);
  }
  else
  {
    s.takeMatcherMotion(frame, context, T_guess);
  }
  s.history.time_without_scan = usable ? 0 : context.time_without_scan;
  s.history.T_odom_previous = frame.T_odom_vehicle;
  s.history.T_sweep_previous = frame.cloud.T_sweep;
}

void Odometry::integrate(const Frame& frame)
{
  State& s = *state_;
  const CTimeLoggerEntry timed(s.times, "refine");
  if (s.registers())
  {
    s.registration.commit(std::move(s.alignment), frame);
  }
}

/** Where the speed at the first scan is known, the segmenter's motion is not needed. */
void Odometry::State::fuseSegmenterMotion(Frame& frame, FrameContext& context)
{
  if (frame.dt > 0 && !frame.static_prior.empty())
  {
    ++history.segmenter_frames;
    history.segmenter_failures += frame.segmenter_motion ? 0 : 1;
  }
  context.segmenter_information.setZero();
  if (!predictor.startSpeedKnown() && gate.acceptsSegmenterMotion(frame, history.T_sweep_previous))
  {
    context.segmenter_information = gate.segmenterInformation();
    frame.prior.fuse(frame.segmenter_motion->T_previous_current, context.segmenter_information);
  }
}

void Odometry::State::matchScan(Frame& frame, FrameContext& context)
{
  ScanMatch match = matcher->match(frame, frame.prior);
  context.matcher_uses_prior = matcher->usesPrior();
  context.starts_map = registration.framesInMap() == 1;
  frame.odometry = std::move(match.motion);
  frame.odometry_rejection = gate.rejectionReason(frame, context);
  frame.odometry_accepted = frame.odometry_rejection.empty();
  frame.static_confidence =
      frame.odometry_accepted ? std::move(match.static_confidence) : std::vector<float>();
}

void Odometry::State::registerToMap(Frame& frame, FrameContext& context, const Pose& T_guess)
{
  alignment = registerFrom(T_guess, frame, context);
  const RegistrationResult& result = alignment.result();
  history.registered = history.registered || result.points > 0;
  if (result.points > 0 && result.motion.registered())
  {
    const bool has_wheels = context.sensed_information(0, 0) > 0;
    ++history.registered_scans;
    history.degenerate_scans += result.degenerate && !has_wheels ? 1 : 0;
  }
  frame.motion = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  predictor.update(frame, context, result);
  uncertainty.calibrate(frame.dt, result.measured_information, frame.motion);
}

/** Registers from the guess. If that fails, from the mean motion of the last scans: after an abrupt
 * motion, or one that was misjudged, the velocity of the last scan alone may be wrong. Then with a
 * prior that has the gyroscope or not, whichever was not tried, which becomes that of the frame. */
LocalMapRegistration::Alignment Odometry::State::registerFrom(const Pose& T_guess,
                                                              Frame& frame,
                                                              FrameContext& context)
{
  const double start_sigma = !history.registered && predictor.startSpeedKnown()
                                 ? options.start_speed_sigma * frame.dt
                                 : refine.initial_sigma;
  const double sigma =
      gate.initialSigma(frame, context, std::min(refine.initial_sigma, start_sigma));
  const auto failed = [](const LocalMapRegistration::Alignment& tried)
  { return tried.result().points > 0 && tried.result().measured_information.isZero(); };
  LocalMapRegistration::Alignment result =
      registration.align(frame, history.T_odom_previous * T_guess, &frame.prior, sigma);
  if (!failed(result) || registration.framesInMap() < 2)
  {
    return result;
  }
  if (const auto steady = predictor.meanVelocityPrior(frame, context))
  {
    result =
        registration.align(frame, history.T_odom_previous * steady->T_previous_current, &*steady);
  }
  Matrix6 sensed_information = Matrix6::Zero();
  const auto other =
      failed(result) ? predictor.priorOtherwise(frame, context, sensed_information) : std::nullopt;
  if (!other)
  {
    return result;
  }
  LocalMapRegistration::Alignment by_other =
      registration.align(frame, history.T_odom_previous * other->T_previous_current, &*other);
  if (failed(by_other))
  {
    return result;
  }
  frame.prior = *other;
  context.sensed_information = sensed_information;
  return by_other;
}

/** Without a registration: the matcher's motion, or the prediction in its place, is the result. */
void Odometry::State::takeMatcherMotion(Frame& frame,
                                        const FrameContext& context,
                                        const Pose& T_guess)
{
  frame.motion = frame.odometry;
  frame.motion.T_previous_current = T_guess;
  uncertainty.calibrateMatch(frame.dt, frame.prior.information, frame.motion);
  frame.T_odom_vehicle = orthonormalised(history.T_odom_previous * T_guess);
  predictor.updateUnregistered(frame, context, T_guess);
}

void Odometry::exchangeState(StateArchive& archive)
{
  state_->exchangeState(archive);
}

std::string Odometry::name() const
{
  std::string name = state_->matcher->name();
  switch (state_->refine.method)
  {
    case RefineMethod::none:
      break;
    case RefineMethod::point_to_plane:
      name += " + point_to_plane";
      break;
    case RefineMethod::gicp:
      name += " + gicp";
      break;
  }
  return name + state_->predictor.sensorNames();
}

std::vector<std::string> Odometry::warnings() const
{
  const State& s = *state_;
  std::vector<std::string> warnings = s.predictor.warnings();
  if (!s.registers() && s.matcher->onlyPredicts() && s.predictor.sensorNames().empty())
  {
    warnings.push_back("nothing measures the motion: odometry.method=" + s.matcher->name() +
                       " only predicts it, and refine.method is none; change one of them");
  }
  constexpr int min_registered = 10;
  constexpr int degenerate_share = 5;  // one of so many scans
  if (s.history.registered_scans >= min_registered &&
      s.history.degenerate_scans * degenerate_share > s.history.registered_scans)
  {
    warnings.push_back(
        std::to_string(s.history.degenerate_scans) + " of " +
        std::to_string(s.history.registered_scans) +
        " registered scans do not determine the motion in some direction, as in an open field: it "
        "is predicted there, so that distances may be wrong; wheel odometry shows them");
  }
  constexpr int min_frames = 4;
  if (!s.predictor.startSpeedKnown() && s.history.segmenter_frames >= min_frames &&
      2 * s.history.segmenter_failures >= s.history.segmenter_frames)
  {
    warnings.emplace_back(
        "the first scans do not determine the speed at the start of the recording; if it is known, "
        "set odometry.start_speed");
  }
  return warnings;
}
}  // namespace dyslam
