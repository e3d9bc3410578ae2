// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/StateArchive.h>
#include <dyslam/odometry/LocalMapRegistration.h>
#include <dyslam/odometry/MotionFilter.h>
#include <dyslam/odometry/MotionSensors.h>
#include <dyslam/odometry/Odometry.h>
#include <dyslam/odometry/ScanClock.h>
#include <dyslam/odometry/ScanMatcher.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "CloudCheck.h"
#include "MotionUncertainty.h"

namespace dyslam
{
using mrpt::system::CTimeLoggerEntry;

namespace
{
constexpr double clearly_better = 0.02;  // difference of inlier shares
constexpr double velocity_share = 0.25;  // of a new velocity in the mean of the last ones
}  // namespace

void OdometryOptions::describe(OptionsVisitor& v)
{
  v.word("method", method, scanMatcherNames(),
         "scan matcher, which estimates the motion between scans");
  v.real("start_speed", start_speed, -50, 100,
         "forward speed at the first scan; 0: not known [m/s]");
  v.real("start_speed_sigma", start_speed_sigma, 1e-3, 100,
         "sigma of start_speed, where that is given [m/s]");
}

void FusionOptions::describe(OptionsVisitor& v)
{
  v.real("segmenter_sigma", segmenter_sigma, 1e-4, 10,
         "sigma of the segmenter's ego-motion in x and y [m]");
  v.degrees("segmenter_sigma_angle_deg", segmenter_sigma_angle, 1e-3, 90,
            "sigma of the heading of the segmenter's ego-motion [deg]");
  v.real("matcher_sigma", matcher_sigma, 1e-4, 10,
         "sigma of the translation of a scan matcher's motion [m]");
  v.degrees("matcher_sigma_angle_deg", matcher_sigma_angle, 1e-3, 90,
            "sigma of the rotation of a scan matcher's motion [deg]");
  v.real("gate", gate, 0.1, 1000,
         "largest Mahalanobis distance to the prior of an accepted motion of segmenter or matcher");
  v.real("informed_sigma", informed_sigma, 1e-4, 10,
         "sigma of the translation of a scan matcher that fuses the prior [m]");
  v.degrees("informed_sigma_angle_deg", informed_sigma_angle, 1e-3, 90,
            "sigma of the rotation of a scan matcher that fuses the prior [deg]");
  v.real("informed_gate", informed_gate, 0.1, 1000,
         "largest Mahalanobis distance to the prior of an accepted motion of a matcher that fuses "
         "the prior");
  v.real(
      "segmenter_initial_sigma", segmenter_initial_sigma, 0, 50,
      "sigma of the initial guess at the first registration to a map, if from the segmenter [m]");
  v.real("matcher_initial_sigma", matcher_initial_sigma, 0, 50,
         "sigma of the initial guess at the first registration to a map, if from a matcher that "
         "fuses the prior [m]");
  v.real("reliable_prior_sigma", reliable_prior_sigma, 0, 100,
         "sigma of the prior below which segmenters search only around the prior [m]");
  v.real("min_static_prior", min_static_prior, 0, 1,
         "static probability by appearance below which points have zero weight");
}

struct Odometry::State
{
  State(ConfigLoader& config,
        ThreadPool& pool,
        mrpt::system::CTimeLogger& time_logger,
        std::unique_ptr<ScanMatcher> given)
      : times(time_logger),
        options(config.get<OdometryOptions>("odometry")),
        fusion(config.get<FusionOptions>("fusion")),
        motion_options(config.get<MotionFilterOptions>("motion")),
        refine(config.get<RefineOptions>("refine")),
        filter(motion_options),
        matcher(given ? std::move(given) : makeScanMatcher(options.method, config, pool)),
        registration(refine, pool),
        sensors(config.get<MotionSensorOptions>("motion_sensors")),
        uncertainty(config.get<UncertaintyOptions>("uncertainty"))
  {
    Vector6 velocity = Vector6::Zero();
    velocity.x() = options.start_speed;
    filter.start(velocity,
                 startSpeedKnown() ? options.start_speed_sigma : motion_options.start_speed_sigma,
                 motion_options.start_turn_rate_sigma);
  }

  /** By the options or by the wheels. */
  [[nodiscard]] bool startSpeedKnown() const
  {
    return options.start_speed != 0 || start_speed_sensed;
  }
  [[nodiscard]] bool registers() const { return refine.method != RefineMethod::none; }
  /** The scan is the first to be registered to its map. */
  [[nodiscard]] bool startsMap() const { return registration.framesInMap() == 1; }

  [[nodiscard]] MotionPrior priorAfter(double dt) const;
  /** The prior is measured by other sensors: it holds without scans. */
  [[nodiscard]] bool isDeadReckoned() const
  {
    return sensed_information(0, 0) > 0 && sensed_information(3, 3) > 0;
  }
  void startAtSensedSpeed(double stamp);
  void senseMotion(const Frame& frame);
  void fuseSensedMotion(double dt, MotionPrior& prior);
  [[nodiscard]] std::optional<Pose> motionAtDoubtfulTime(
      const Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare);
  void countSegmenterMotions(const Frame& frame);
  [[nodiscard]] bool acceptsSegmenterMotion(const Frame& frame) const;
  void fuseSegmenterMotion(Frame& frame);
  [[nodiscard]] std::string whyRejected(const Frame& frame) const;
  void matchScan(Frame& frame);
  void weightByAppearance(Frame& frame) const;
  [[nodiscard]] Pose initialGuess(const Frame& frame) const;
  [[nodiscard]] double initialSigma(const Frame& frame) const;
  [[nodiscard]] RegistrationResult registerFrom(const Frame& frame, const Pose& T_guess);
  void updateMeanVelocity(const Frame& frame);
  void registerToMap(Frame& frame, const Pose& T_guess);
  void takeMatcherMotion(Frame& frame, const Pose& T_guess);

  mrpt::system::CTimeLogger& times;
  OdometryOptions options;
  FusionOptions fusion;
  MotionFilterOptions motion_options;
  RefineOptions refine;
  MotionFilter filter;
  std::unique_ptr<ScanMatcher> matcher;
  LocalMapRegistration registration;
  MotionSensors sensors;
  MotionUncertainty uncertainty;

  ScanClock clock;
  bool doubtful = false;                 //!< the interval to the scan at hand
  bool after_gap = false;                //!< too long to predict the velocity after it
  bool started = false;                  //!< a scan has been seen
  bool registered = false;               //!< a scan has been registered to the map
  std::optional<Vector6> mean_velocity;  //!< of the last scans registered [m/s, rad/s]
  double without_scan = 0;               //!< time since the last usable scan [s]
  Pose T_odom_previous = Pose::Identity();
  Pose T_sweep_previous = Pose::Identity();  //!< that the previous cloud was deskewed with
  /** Of the segmenter's motion, if it was fused with the frame's prior; else zero. */
  Matrix6 segmenter_information = Matrix6::Zero();
  bool moved = false;                            //!< there was a motion between two scans
  bool start_speed_sensed = false;               //!< by the wheels
  std::optional<SensedMotion> sensed;            //!< between the stamps of the last two scans
  Matrix6 sensed_information = Matrix6::Zero();  //!< of `sensed`, as fused with the frame's prior
  int segmenter_frames = 0;                      //!< with an appearance prior
  int segmenter_failures = 0;                    //!< of those, with no ego-motion found
};

void Odometry::State::countSegmenterMotions(const Frame& frame)
{
  if (frame.dt > 0 && !frame.static_prior.empty())
  {
    ++segmenter_frames;
    segmenter_failures += frame.segmenter_motion ? 0 : 1;
  }
}

/** The segmenter's ego-motion is used as long as it has an appearance prior: estimated from static
 * classes, it is not biased by surrounding traffic. Two scans that were deskewed by different
 * motions do not determine the motion between them. */
bool Odometry::State::acceptsSegmenterMotion(const Frame& frame) const
{
  if (!frame.segmenter_motion || frame.static_prior.empty() || frame.dt <= 0 || startSpeedKnown())
  {
    return false;
  }
  const Pose sweep_change = T_sweep_previous.inverse() * frame.cloud.T_sweep;
  return sweep_change.translation().norm() < fusion.segmenter_sigma &&
         frame.prior.mahalanobisDistance(frame.segmenter_motion->T_previous_current,
                                         fusion.segmenter_sigma,
                                         fusion.segmenter_sigma_angle) < fusion.gate;
}

void Odometry::State::fuseSegmenterMotion(Frame& frame)
{
  segmenter_information.setZero();
  if (acceptsSegmenterMotion(frame))
  {
    segmenter_information =
        informationFromSigmas(fusion.segmenter_sigma, fusion.segmenter_sigma_angle);
    // A segmenter in the bird's-eye view observes neither height nor tilt.
    segmenter_information.diagonal().segment<3>(2).setZero();
    frame.prior.fuse(frame.segmenter_motion->T_previous_current, segmenter_information);
  }
}

/** A matcher may follow surrounding traffic instead of the static world: its motion is accepted
 * only near the prior. \return why it is rejected; empty if it is accepted */
std::string Odometry::State::whyRejected(const Frame& frame) const
{
  if (!frame.odometry.converged)
  {
    return frame.odometry.reason;
  }
  if (!registers())
  {
    return {};
  }
  if (startsMap() && !segmenter_information.isZero())
  {
    return "the segmenter's motion is the initial guess of the first registration";
  }
  const bool informed = frame.dt > 0 && matcher->usesPrior();
  const double distance = frame.prior.mahalanobisDistance(
      frame.odometry.T_previous_current, informed ? fusion.informed_sigma : fusion.matcher_sigma,
      informed ? fusion.informed_sigma_angle : fusion.matcher_sigma_angle);
  const double gate = informed ? fusion.informed_gate : fusion.gate;
  if (distance < gate)
  {
    return {};
  }
  char text[80];
  std::snprintf(text, sizeof text, "%.1f sigmas from the prior; the gate is %.1f", distance, gate);
  return text;
}

void Odometry::State::matchScan(Frame& frame)
{
  ScanMatch match = matcher->match(frame, frame.prior);
  frame.odometry = std::move(match.motion);
  frame.odometry_rejection = whyRejected(frame);
  frame.odometry_accepted = frame.odometry_rejection.empty();
  frame.static_confidence =
      frame.odometry_accepted ? std::move(match.static_confidence) : std::vector<float>();
  weightByAppearance(frame);
}

/** Until motion can be observed, points of movable appearance have zero weight. */
void Odometry::State::weightByAppearance(Frame& frame) const
{
  if (frame.static_prior.empty() || frame.static_prior.size() != frame.cloud.size())
  {
    return;
  }
  const auto least = static_cast<float>(fusion.min_static_prior);
  frame.static_confidence.resize(frame.cloud.size(), 1.0F);
  std::transform(frame.static_prior.begin(), frame.static_prior.end(),
                 frame.static_confidence.begin(), frame.static_confidence.begin(),
                 [least](float prior, float confidence)
                 { return prior < least ? 0.0F : confidence; });
}

/** The matcher's motion, if accepted; one that already contains the prior is fused with it again:
 * the more certain the prior, the lower the weight of a matcher that may follow the traffic. */
Pose Odometry::State::initialGuess(const Frame& frame) const
{
  if (!frame.odometry_accepted)
  {
    return frame.prior.T_previous_current;
  }
  if (!registers() || !matcher->usesPrior())
  {
    return frame.odometry.T_previous_current;
  }
  MotionPrior fused = frame.prior;
  fused.fuse(frame.odometry.T_previous_current,
             informationFromSigmas(fusion.matcher_sigma, fusion.matcher_sigma_angle));
  return fused.T_previous_current;
}

/** Sigma of the initial guess, if this is the first registration to a map [m]. */
double Odometry::State::initialSigma(const Frame& frame) const
{
  double sigma = refine.initial_sigma;
  if (!registered && startSpeedKnown())
  {
    sigma = std::min(sigma, options.start_speed_sigma * frame.dt);
  }
  if (!segmenter_information.isZero())
  {
    sigma = std::min(sigma, fusion.segmenter_initial_sigma);
  }
  if (frame.odometry_accepted && matcher->usesPrior())
  {
    sigma = std::min(sigma, fusion.matcher_initial_sigma);
  }
  return sigma;
}

/** Registers from the guess and, if that fails, from the mean motion of the last scans, except for
 * what other sensors measured: after an abrupt motion, or one that was misjudged, the velocity of
 * the last scan alone may be wrong. */
RegistrationResult Odometry::State::registerFrom(const Frame& frame, const Pose& T_guess)
{
  const RegistrationResult result = registration.registerFrame(frame, T_odom_previous * T_guess,
                                                               &frame.prior, initialSigma(frame));
  const bool failed = result.points > 0 && result.measured_information.isZero();
  if (!failed || !mean_velocity || after_gap || registration.framesInMap() < 2)
  {
    return result;
  }
  MotionPrior steady = frame.prior;
  Vector6 step = frame.dt * *mean_velocity;
  const Vector6 of_prior = logSE3(frame.prior.T_previous_current);
  for (Eigen::Index i = 0; i < step.size(); ++i)
  {
    step[i] = sensed_information(i, i) > 0 ? of_prior[i] : step[i];
  }
  steady.T_previous_current = expSE3(step);
  return registration.registerAgain(frame, T_odom_previous * steady.T_previous_current, &steady);
}

void Odometry::State::updateMeanVelocity(const Frame& frame)
{
  if (frame.dt <= 0 || !frame.motion.converged || after_gap)
  {
    return;
  }
  const Vector6 velocity = logSE3(frame.motion.T_previous_current) / frame.dt;
  mean_velocity = mean_velocity
                      ? Vector6(*mean_velocity + velocity_share * (velocity - *mean_velocity))
                      : velocity;
}

void Odometry::State::registerToMap(Frame& frame, const Pose& T_guess)
{
  const RegistrationResult result = registerFrom(frame, T_guess);
  registered = registered || result.points > 0;
  frame.motion = result.motion;
  frame.T_odom_vehicle = result.T_odom_vehicle;
  if (after_gap || (without_scan > ScanClock::max_extrapolation && !isDeadReckoned()))
  {
    filter.forget(std::max(frame.dt, without_scan));
  }
  else
  {
    const Vector6 root = result.prior_weight.cwiseSqrt();
    filter.update(frame.dt, result.motion.T_previous_current,
                  result.measured_information + segmenter_information +
                      Matrix6(root.asDiagonal() * sensed_information * root.asDiagonal()),
                  result.prior_weight);
  }
  if (sensed && frame.dt == clock.interval() && result.points > 0 && frame.motion.converged)
  {
    sensors.compare(*sensed, sensed_information, frame.dt, frame.motion.T_previous_current,
                    result.measured_information);
  }
  updateMeanVelocity(frame);
  uncertainty.calibrate(frame.dt, result.measured_information, frame.motion);
}

void Odometry::State::takeMatcherMotion(Frame& frame, const Pose& T_guess)
{
  frame.motion = frame.odometry;
  uncertainty.calibrateMatch(frame.dt, frame.prior.information, frame.motion);
  frame.T_odom_vehicle = orthonormalized(T_odom_previous * T_guess);
  if (after_gap)
  {
    filter.forget(frame.dt);
    return;
  }
  if (!matcher->usesPrior())
  {
    filter.follow(frame.dt, T_guess);
    return;
  }
  const Matrix6 measured =
      frame.odometry_accepted ? frame.odometry.information : Matrix6(Matrix6::Zero());
  filter.update(frame.dt, T_guess, measured + segmenter_information + sensed_information);
}

MotionPrior Odometry::State::priorAfter(double dt) const
{
  MotionPrior prior;
  prior.T_previous_current = filter.predict(dt);
  prior.information = filter.information(dt);
  prior.reliable = started && (startSpeedKnown() || filter.sigma(dt) < fusion.reliable_prior_sigma);
  return prior;
}

/** Of a recording that begins in motion, by the wheels. \param stamp of the first scan */
void Odometry::State::startAtSensedSpeed(double stamp)
{
  const auto speed = sensors.speedAt(stamp);
  if (speed && !startSpeedKnown())
  {
    Vector6 velocity = Vector6::Zero();
    velocity.x() = *speed;
    filter.start(velocity, options.start_speed_sigma, motion_options.start_turn_rate_sigma);
    start_speed_sensed = true;
  }
}

/** By the other sensors, since the scan before. */
void Odometry::State::senseMotion(const Frame& frame)
{
  sensors.add(frame);
  const double interval = clock.interval();
  sensed.reset();
  if (interval <= 0 || interval > ScanClock::max_extrapolation)
  {
    return;
  }
  const double before = frame.scan.stamp - interval;
  if (!moved)
  {
    startAtSensedSpeed(before);
  }
  moved = true;
  sensed = sensors.sense(before, frame.scan.stamp, filter.predict(interval));
}

/** Nothing, if `dt` is not the time between the stamps. */
void Odometry::State::fuseSensedMotion(double dt, MotionPrior& prior)
{
  sensed_information.setZero();
  if (sensed && dt == clock.interval())
  {
    sensed_information = sensors.fuse(*sensed, prior);
  }
}

/** Motion since the scan before for an unknown interval: the initial guess that registers best, of
 * constant velocity for the interval, constant velocity for one period, and no motion. */
std::optional<Pose> Odometry::State::motionAtDoubtfulTime(
    const Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare)
{
  if (!registers() || registration.framesInMap() < 2)
  {
    return std::nullopt;
  }
  const double interval = clock.interval();
  std::vector<std::pair<double, MotionPrior>> starts;
  if (interval > 0 && interval <= ScanClock::max_extrapolation)
  {
    starts.emplace_back(interval, priorAfter(interval));
    fuseSensedMotion(interval, starts.back().second);
  }
  starts.emplace_back(clock.period(), priorAfter(clock.period()));
  if (interval > 0)
  {
    starts.emplace_back(interval, priorAfter(std::min(interval, ScanClock::max_extrapolation)));
    starts.back().second.T_previous_current = Pose::Identity();
  }
  Frame trial = frame;
  std::optional<Pose> T_best;
  double best = 0;
  for (const auto& [dt, prior] : starts)
  {
    trial.dt = dt;
    trial.prior = prior;
    trial.cloud = prepare(prior.T_previous_current, dt);
    const RegistrationResult found =
        registration.tryFrame(trial, T_odom_previous * prior.T_previous_current, &prior);
    if (found.motion.converged && (!T_best || found.inlier_share > best + clearly_better))
    {
      T_best = found.motion.T_previous_current;
      best = found.inlier_share;
    }
  }
  return T_best;
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
  s.clock.advance(frame.scan.stamp);
  s.doubtful = s.clock.isDoubtful();
  s.after_gap = false;
  frame.sweep_duration = s.clock.sweepDuration();
  frame.dt = frame.sweep_duration;  // settleTime() corrects it
  frame.clock_offset = s.clock.offset();
  s.senseMotion(frame);
  frame.prior = s.priorAfter(frame.dt);
  s.fuseSensedMotion(frame.dt, frame.prior);
  frame.T_odom_vehicle = s.T_odom_previous * frame.prior.T_previous_current;
  s.started = true;
}

void Odometry::settleTime(Frame& frame, const std::function<Cloud(const Pose&, double)>& prepare)
{
  State& s = *state_;
  if (!s.doubtful)
  {
    s.clock.settle(s.clock.interval());
    return;
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  const std::optional<Pose> T_found = s.motionAtDoubtfulTime(frame, prepare);
  const bool set = T_found
                       ? showsClockStep(s.filter, s.clock.interval(), s.clock.period(), *T_found)
                       : s.clock.interval() <= 0;
  frame.dt = set ? s.clock.period() : s.clock.interval();
  s.clock.settle(frame.dt);
  s.after_gap = frame.dt > ScanClock::max_extrapolation;
  frame.clock_offset = s.clock.offset();
  frame.prior = s.priorAfter(std::min(frame.dt, ScanClock::max_extrapolation));
  s.fuseSensedMotion(frame.dt, frame.prior);
  if (T_found && !set)
  {
    frame.prior.T_previous_current = *T_found;
  }
  frame.T_odom_vehicle = s.T_odom_previous * frame.prior.T_previous_current;
  // Beyond the extrapolation the prior covers a part of dt; the sweep is deskewed by its velocity.
  const double beyond = frame.dt / ScanClock::max_extrapolation;
  frame.cloud =
      prepare(s.after_gap && !T_found ? expSE3(beyond * logSE3(frame.prior.T_previous_current))
                                      : frame.prior.T_previous_current,
              frame.dt);
}

void Odometry::estimate(Frame& frame)
{
  State& s = *state_;
  {
    const CTimeLoggerEntry timed(s.times, "odometry");
    s.countSegmenterMotions(frame);
    s.fuseSegmenterMotion(frame);
    s.matchScan(frame);
  }
  const CTimeLoggerEntry timed(s.times, "refine");
  const bool usable = reasonUnusable(frame).empty();
  s.without_scan += frame.dt;
  const bool extrapolates =
      usable || s.without_scan <= ScanClock::max_extrapolation || s.isDeadReckoned();
  const Pose T_guess = extrapolates ? s.initialGuess(frame) : Pose::Identity();
  if (s.registers())
  {
    s.registerToMap(frame, T_guess);
  }
  else
  {
    s.takeMatcherMotion(frame, T_guess);
  }
  s.without_scan = usable ? 0 : s.without_scan;
  s.T_odom_previous = frame.T_odom_vehicle;
  s.T_sweep_previous = frame.cloud.T_sweep;
}

void Odometry::integrate(const Frame& frame)
{
  const CTimeLoggerEntry timed(state_->times, "refine");
  state_->registration.integrate(frame);
}

void Odometry::exchangeState(StateArchive& archive)
{
  State& s = *state_;
  archive(s.filter, *s.matcher, s.registration, s.uncertainty, s.clock, s.started, s.registered,
          s.without_scan, s.mean_velocity, s.T_odom_previous, s.T_sweep_previous,
          s.segmenter_frames, s.segmenter_failures, s.sensors, s.moved, s.start_speed_sensed);
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
  return name + state_->sensors.name();
}

std::vector<std::string> Odometry::warnings() const
{
  const State& s = *state_;
  std::vector<std::string> warnings;
  if (std::string of_clock = s.clock.warning(); !of_clock.empty())
  {
    warnings.push_back(std::move(of_clock));
  }
  for (std::string& of_sensor : s.sensors.warnings())
  {
    warnings.push_back(std::move(of_sensor));
  }
  if (!s.registers() && s.matcher->name() == "constant_velocity" && s.sensors.name().empty())
  {
    warnings.emplace_back(
        "nothing measures the motion: odometry.method=constant_velocity only predicts it, and "
        "refine.method is none; change one of them");
  }
  constexpr int min_frames = 4;
  if (!s.startSpeedKnown() && s.segmenter_frames >= min_frames &&
      2 * s.segmenter_failures >= s.segmenter_frames)
  {
    warnings.emplace_back(
        "the first scans do not determine the speed at the start of the recording; if it is known, "
        "set odometry.start_speed");
  }
  return warnings;
}
}  // namespace dyslam
