// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Squared.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/MotionSensors.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <deque>

#include "GyroscopeClock.h"
#include "SampledSignal.h"
#include "SensorUse.h"

namespace dyslam
{
namespace
{
constexpr double sample_memory = 10;  //!< age beyond which samples are dropped [s]
constexpr double max_ahead = 1;       //!< largest time of a sample after its scan [s]
/** Samples beyond these, which are far above any in wrong units, are damaged. */
constexpr double max_rate = 1e4;   //!< [rad/s]
constexpr double max_speed = 1e5;  //!< [m/s]
/** Sigma of the acceleration where the last sample is held. */
constexpr double held_acceleration = 3;          //!< [m/s^2]
constexpr double held_angular_acceleration = 3;  //!< [rad/s^2]
/** Lower limits of the sigmas of a motion between two scans. */
constexpr double least_sigma = 2e-3;        //!< [m]
constexpr double least_sigma_angle = 2e-4;  //!< [rad]
/** Sigmas of a motion by the scans, of the two independent poses at its ends. */
constexpr double found_sigma = 0.01;         //!< [m]
constexpr double found_sigma_angle = 0.001;  //!< [rad]
/** Least share of the scans' information in an estimated motion that is used for comparison. */
constexpr double min_scan_share = 0.2;
constexpr double min_displacement = 0.05;  //!< least displacement for the scale of the speeds [m]
constexpr double outlier = 5;              //!< limit of outliers [sigma]
/** Deviation of the gyroscope from the prior beyond which the prior's weight falls [sigma]. */
constexpr double turn_gate = 3;
/** Least share of the initial variance of the scale, which changes with time. */
constexpr double least_variance = 0.01;
/** Change of the gyroscope's bias with time, a random walk [rad/s/sqrt(s)]. */
constexpr double bias_walk = 5e-5;
/** Least share of the scans in an estimated rotation that is compared. */
constexpr double least_share = 0.005;
constexpr double conflict_share = 0.1;  //!< weight of a new rotation in State::conflict
constexpr double max_conflict = 0.5;    //!< conflict above which the gyroscope is not trusted

/** A constant estimated from noisy measurements. */
struct Constant
{
  double value = 0;
  double variance = 0;

  [[nodiscard]] bool contradicts(double measured, double measured_variance) const
  {
    return squared(measured - value) > squared(outlier) * (variance + measured_variance);
  }
  /** Adds a measurement. \param least least variance after it */
  void update(double measured, double measured_variance, double least)
  {
    const double gain = variance / (variance + measured_variance);
    value += gain * (measured - value);
    variance = std::max(least, (1 - gain) * variance);
  }
};

/** Kalman filter of the bias of the gyroscope about one axis. Beside the bias it has the error of
 * the heading that the odometry kept: a scan corrects that only in part where the gyroscope has
 * more weight, so that an error of the bias shows in the sum over many scans. */
struct AxisBias
{
  double value = 0;           //!< [rad/s]
  double angle_variance = 0;  //!< of the error of the angle that was kept [rad^2]
  double covariance = 0;      //!< of that and of the bias [rad^2/s]
  double variance = 0;        //!< of the bias [rad^2/s^2]

  /** From one scan to the next. \param noise variance of the gyroscope's rotation [rad^2] */
  void predict(double dt, double noise)
  {
    angle_variance += 2 * dt * covariance + dt * dt * variance + noise;
    covariance += dt * variance;
    variance += squared(bias_walk) * dt;
  }
  /** Whether the angle by the gyroscope minus that by the scans is impossible. */
  [[nodiscard]] bool contradicts(double error, double of_scans) const
  {
    return squared(error) > squared(outlier) * (angle_variance + of_scans);
  }
  /** \param error angle by the gyroscope minus that by the scans [rad] \param of_scans variance of
   * the latter [rad^2] \param share of `error` by which the odometry was corrected */
  void update(double error, double of_scans, double share)
  {
    const double gain = covariance / (angle_variance + of_scans);
    value += gain * error;
    // Joseph's form, as `share` is not the optimal gain.
    const double rest = 1 - share;
    variance += gain * gain * (angle_variance + of_scans) - 2 * gain * covariance;
    covariance = rest * (covariance - gain * angle_variance) + share * gain * of_scans;
    angle_variance = rest * rest * angle_variance + share * share * of_scans;
  }
};

/** Comparison of the gyroscope's angular velocities, while they are not used, with those that the
 * scans show: it tells whether they fit, and the unit. */
struct RotationEvidence
{
  static constexpr std::size_t least_motions = 10;

  std::size_t motions = 0;
  // Sums over the last motions
  double of_scans = 0;      //!< of the squares [rad^2/s^2]
  double of_gyroscope = 0;  //!< of the squares
  double products = 0;      //!< of the products
  double noise = 0;         //!< of the expected squares of the scans' errors

  void add(const Eigen::Vector3d& gyroscope, const Eigen::Vector3d& scans, double expected_noise)
  {
    constexpr double kept = 0.98;  // about the last 50 motions count
    ++motions;
    of_scans = kept * of_scans + scans.squaredNorm();
    of_gyroscope = kept * of_gyroscope + gyroscope.squaredNorm();
    products = kept * products + gyroscope.dot(scans);
    noise = kept * noise + expected_noise;
  }
  /** Angular velocity of the gyroscope over that of the scans (least squares). */
  [[nodiscard]] double ratio() const { return of_scans > 0 ? products / of_scans : 0; }
  /** Whether the vehicle turned, and both measured the same. */
  [[nodiscard]] bool fits() const
  {
    constexpr double least_correlation2 = 0.8;  // squared
    constexpr double most_ratio = 1.25;
    return motions >= least_motions && products > of_gyroscope / most_ratio &&
           products < of_gyroscope * most_ratio &&
           squared(products) > least_correlation2 * of_scans * of_gyroscope;
  }
  /** Whether the vehicle certainly turned. */
  [[nodiscard]] bool showsTurns() const
  {
    constexpr double least_ratio = 4;
    return motions >= 2 * least_motions && of_scans > least_ratio * noise;
  }
  /** Whether the gyroscope's are in deg/s: the ratio is near 57.3, and both have the same course.
   */
  [[nodiscard]] bool isOfDegrees() const
  {
    constexpr double least_correlation2 = 0.9;  // squared
    constexpr double least_ratio = 45;
    constexpr double most_ratio = 70;
    return motions >= least_motions && ratio() > least_ratio && ratio() < most_ratio &&
           squared(products) > least_correlation2 * of_scans * of_gyroscope;
  }
};

/** Error of a sensor relative to the scans only, from its error relative to the estimated motion,
 * which is the mean of both by their information. \return nothing if that is mostly the sensor's */
std::optional<double> errorAgainstScans(double error, double of_sensor, double of_scans)
{
  if (of_scans <= min_scan_share * (of_scans + of_sensor))
  {
    return std::nullopt;
  }
  return error * (of_scans + of_sensor) / of_scans;
}

template <typename Value>
void dropOutside(double begin, double end, std::deque<Sample<Value>>& samples)
{
  while (!samples.empty() && samples.front().stamp < begin)
  {
    samples.pop_front();
  }
  while (!samples.empty() && samples.back().stamp > end)
  {
    samples.pop_back();
  }
}
}  // namespace

void MotionSensorOptions::describe(OptionsVisitor& v)
{
  v.flag("gyroscope", gyroscope, "use the angular velocities of an IMU");
  v.choice("gyroscope_unit", gyroscope_unit,
           {{"rad_s", GyroscopeUnit::rad_s}, {"deg_s", GyroscopeUnit::deg_s}},
           "unit of the recording's angular velocities: rad/s, or deg/s by mistake");
  v.flag("gyroscope_check", gyroscope_check,
         "use the gyroscope only once its rotations were those of the scans; false: from the first "
         "scan on");
  v.flag("wheel_odometry", wheel_odometry, "use the forward speed of the wheels");
  v.degrees("gyroscope_sigma_deg_s", gyroscope_sigma, 1e-4, 1e3,
            "sigma of the mean angular velocity between two scans [deg/s]");
  v.real("gyroscope_sigma_ratio", gyroscope_sigma_ratio, 0, 1,
         "sigma of the angular velocity in proportion to it (alignment of axes and clocks)");
  v.degrees("gyroscope_bias_sigma_deg_s", gyroscope_bias_sigma, 1e-5, 1e3,
            "sigma of the gyroscope's bias before it is estimated [deg/s]");
  v.real("wheel_sigma", wheel_sigma, 1e-4, 100,
         "sigma of the mean speed of the wheels between two scans [m/s]");
  v.real("wheel_scale_sigma", wheel_scale_sigma, 1e-5, 1,
         "sigma of the relative scale error of the wheels' speed before it is estimated");
  v.real("wheel_gate", wheel_gate, 0.1, 1000,
         "a speed of the wheels farther from the prior than this many sigmas is rejected");
  v.real("max_gap", max_gap, 1e-3, 10,
         "largest time without a sample over which a sensor is used [s]");
  v.renamed("gyroscope_sigma_deg", "gyroscope_sigma_deg_s");
  v.renamed("gyroscope_bias_sigma_deg", "gyroscope_bias_sigma_deg_s");
}

struct MotionSensors::State
{
  using Rates = SampledSignal<Eigen::Vector3d>;
  using Speeds = SampledSignal<double>;

  explicit State(const MotionSensorOptions& sensor_options) : options(sensor_options)
  {
    validate(options, "motion_sensors");
    bias.fill({0, 0, 0, squared(options.gyroscope_bias_sigma)});
    scale = {0, squared(options.wheel_scale_sigma)};
    trusts_gyroscope = !options.gyroscope_check;
  }

  [[nodiscard]] Eigen::Vector3d biasVector() const
  {
    return {bias[0].value, bias[1].value, bias[2].value};
  }
  /** Motion by the samples. \param stamps of two successive scans [s] */
  [[nodiscard]] std::optional<SensedMotion> motionBy(const Rates& of_rates,
                                                     const Speeds& of_speeds,
                                                     std::vector<double> stamps,
                                                     const Pose& T_predicted,
                                                     bool with_gyroscope) const;
  [[nodiscard]] Matrix6 informationOf(const SensedMotion& sensed,
                                      double dt,
                                      const Rates& of_rates,
                                      const Speeds& of_speeds,
                                      bool with_gyroscope) const;
  void compareRotation(const SensedMotion& sensed,
                       const Matrix6& fused,
                       double dt,
                       const Pose& T_found,
                       const Matrix6& measured);
  void compareDisplacement(double sensed, double fused, double dt, double found, double measured);

  MotionSensorOptions options;
  std::deque<Sample<Eigen::Vector3d>> rates;  //!< angular velocities, vehicle frame [rad/s]
  std::deque<Sample<double>> speeds;          //!< forward speeds [m/s]
  std::array<AxisBias, 3> bias;               //!< of the angular velocity
  Constant scale;                             //!< scale error: sensed over true speed, minus one
  /** The gyroscope is used: its rotations were those of the scans, and few contradicted since. */
  bool trusts_gyroscope = false;
  double conflict = 0;        //!< recent share of rotations that contradict the scans
  RotationEvidence evidence;  //!< since the gyroscope is not used
  bool in_degrees = false;    //!< the gyroscope's unit is certainly deg/s: it is not used any more
  SensorUse gyroscope;
  SensorUse wheels;
  GyroscopeClock clock;
};

MotionSensors::MotionSensors(const MotionSensorOptions& options)
    : state_(std::make_unique<State>(options))
{
}
MotionSensors::~MotionSensors() = default;
MotionSensors::MotionSensors(MotionSensors&&) noexcept = default;

void MotionSensors::add(const Frame& frame)
{
  State& s = *state_;
  const double begin = frame.scan.stamp - sample_memory;
  const double end = frame.scan.stamp + max_ahead;
  const double unit = s.options.gyroscope_unit == GyroscopeUnit::deg_s ? radians_per_degree : 1;
  const auto isNext = [&](double stamp, const auto& samples)
  { return stamp >= begin && stamp <= end && (samples.empty() || stamp > samples.back().stamp); };
  dropOutside(begin, end, s.rates);
  dropOutside(begin, end, s.speeds);
  for (const ImuSample& sample : frame.imu)
  {
    if (s.options.gyroscope && isNext(sample.stamp, s.rates) &&
        (sample.angular_velocity.array().abs() < max_rate).all())  // not if one is NaN
    {
      s.rates.push_back(
          {sample.stamp, unit * (sample.T_vehicle_imu.linear() * sample.angular_velocity)});
    }
  }
  for (const WheelSample& sample : frame.wheels)
  {
    if (s.options.wheel_odometry && isNext(sample.stamp, s.speeds) &&
        std::abs(sample.forward_speed) < max_speed)
    {
      s.speeds.push_back({sample.stamp, sample.forward_speed});
    }
  }
  s.clock.compare(s.rates, s.options.max_gap);
}

std::optional<SensedMotion> MotionSensors::sense(double begin, double end, const Pose& T_predicted)
{
  State& s = *state_;
  const State::Rates rates(s.rates, begin, end, s.options.max_gap);
  const State::Speeds speeds(s.speeds, begin, end, s.options.max_gap);
  if (s.gyroscope.motions > 0 || !s.rates.empty())
  {
    s.gyroscope.count(rates.isComplete());
  }
  if (s.wheels.motions > 0 || !s.speeds.empty())
  {
    s.wheels.count(speeds.isComplete());
  }
  return s.motionBy(rates, speeds, {begin, end}, T_predicted, s.trusts_gyroscope);
}

std::optional<SensedMotion> MotionSensors::senseOtherwise(double begin,
                                                          double end,
                                                          const Pose& T_predicted) const
{
  const State& s = *state_;
  const State::Rates rates(s.rates, begin, end, s.options.max_gap);
  const State::Speeds speeds(s.speeds, begin, end, s.options.max_gap);
  const bool is_wrong = !s.trusts_gyroscope && (s.in_degrees || s.evidence.showsTurns());
  return rates.isComplete() && !is_wrong
             ? s.motionBy(rates, speeds, {begin, end}, T_predicted, !s.trusts_gyroscope)
             : std::nullopt;
}

std::optional<SensedMotion> MotionSensors::State::motionBy(const Rates& of_rates,
                                                           const Speeds& of_speeds,
                                                           std::vector<double> stamps,
                                                           const Pose& T_predicted,
                                                           bool with_gyroscope) const
{
  const double dt = stamps.back() - stamps.front();
  if (dt <= 0 || (!of_rates.isComplete() && !of_speeds.isComplete()))
  {
    return std::nullopt;
  }
  of_rates.addStampsWithin(stamps);
  of_speeds.addStampsWithin(stamps);
  std::sort(stamps.begin(), stamps.end());
  SensedMotion sensed;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double distance = 0;
  Vector6 velocity = logSE3(T_predicted) / dt;
  for (std::size_t i = 1; i < stamps.size(); ++i)
  {
    const double step = stamps[i] - stamps[i - 1];
    const double middle = 0.5 * (stamps[i] + stamps[i - 1]);
    if (of_rates.isComplete())
    {
      const Eigen::Vector3d rate = of_rates.at(middle) - biasVector();
      rotation = rotation * expSO3(step * rate);
      sensed.mean_rate += step / dt * of_rates.at(middle);
      velocity.tail<3>() = with_gyroscope ? rate : Eigen::Vector3d(velocity.tail<3>());
    }
    if (of_speeds.isComplete())
    {
      velocity.x() = of_speeds.at(middle) / (1 + scale.value);
    }
    distance += step * velocity.x();
    sensed.T_previous_current = sensed.T_previous_current * expSE3(step * velocity);
  }
  if (of_rates.isComplete())
  {
    sensed.rotation = rotation;
  }
  if (of_speeds.isComplete())
  {
    sensed.displacement = distance;
  }
  sensed.information = informationOf(sensed, dt, of_rates, of_speeds, with_gyroscope);
  return sensed;
}

Matrix6 MotionSensors::State::informationOf(const SensedMotion& sensed,
                                            double dt,
                                            const Rates& of_rates,
                                            const Speeds& of_speeds,
                                            bool with_gyroscope) const
{
  Matrix6 information = Matrix6::Zero();
  if (sensed.rotation && with_gyroscope)
  {
    const double angle = rotationAngle(sensed.T_previous_current);
    const double noise =
        squared(options.gyroscope_sigma * dt) + squared(options.gyroscope_sigma_ratio * angle) +
        squared(of_rates.heldError(held_angular_acceleration) * dt) + squared(least_sigma_angle);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const auto i = static_cast<Eigen::Index>(3 + axis);
      information(i, i) = 1 / (noise + squared(dt) * bias[axis].variance);
    }
  }
  if (sensed.displacement)
  {
    information(0, 0) =
        1 / (squared(options.wheel_sigma * dt) + squared(*sensed.displacement) * scale.variance +
             squared(of_speeds.heldError(held_acceleration) * dt) + squared(least_sigma));
  }
  return information;
}

std::optional<double> MotionSensors::speedAt(double stamp) const
{
  const State::Speeds speeds(state_->speeds, stamp, stamp, state_->options.max_gap);
  return speeds.isComplete() ? std::optional(speeds.at(stamp)) : std::nullopt;
}

Matrix6 MotionSensors::fuse(const SensedMotion& sensed, MotionPrior& prior) const
{
  Matrix6 added = sensed.information;
  if (added(0, 0) > 0)
  {
    const Matrix6 covariance = prior.information.llt().solve(Matrix6::Identity());
    const double off = logSE3(prior.T_previous_current).x() - *sensed.displacement;
    if (squared(off) > squared(state_->options.wheel_gate) * (covariance(0, 0) + 1 / added(0, 0)))
    {
      added(0, 0) = 0;
    }
  }
  if (added(3, 3) > 0)
  {
    const Eigen::Vector3d off =
        logSO3(prior.T_previous_current.linear().transpose() * sensed.T_previous_current.linear());
    const double distance2 = off.dot(prior.information.bottomRightCorner<3, 3>() * off);
    const double root = 1 / std::sqrt(1 + distance2 / squared(turn_gate));
    prior.information.bottomRows<3>() *= root;
    prior.information.rightCols<3>() *= root;
  }
  prior.fuse(sensed.T_previous_current, added);
  return added;
}

void MotionSensors::compare(const SensedMotion& sensed,
                            const Matrix6& fused,
                            double dt,
                            const Pose& T_previous_current,
                            const Matrix6& measured)
{
  State& s = *state_;
  if (sensed.rotation)
  {
    s.compareRotation(sensed, fused, dt, T_previous_current, measured);
  }
  if (sensed.displacement)
  {
    s.compareDisplacement(*sensed.displacement, fused(0, 0), dt, logSE3(T_previous_current).x(),
                          measured(0, 0));
  }
}

void MotionSensors::compareClocks(double begin, double end, const Pose& T_previous_current)
{
  if (!state_->rates.empty() && end > begin)
  {
    state_->clock.add(begin, end, logSO3(T_previous_current.linear()) / (end - begin));
  }
}

void MotionSensors::State::compareRotation(const SensedMotion& sensed,
                                           const Matrix6& fused,
                                           double dt,
                                           const Pose& T_found,
                                           const Matrix6& measured)
{
  const Eigen::Vector3d off = logSO3(T_found.linear().transpose() * *sensed.rotation);
  const double angle = rotationAngle(T_found);
  const double noise = squared(options.gyroscope_sigma * dt) +
                       squared(options.gyroscope_sigma_ratio * angle) + squared(least_sigma_angle);
  bool contradicts = false;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const auto i = static_cast<Eigen::Index>(axis);
    const double information = measured(3 + i, 3 + i);
    const double share = information / (information + fused(3 + i, 3 + i));
    if (!(share > least_share))
    {
      return;
    }
    // Relative to the scans only: the motion is the mean of both by their information.
    const double error = off[i] / share;
    const double of_scans = 1 / information + squared(found_sigma_angle);
    bias[axis].predict(dt, noise);
    if (bias[axis].contradicts(error, of_scans))
    {
      contradicts = true;
      continue;
    }
    bias[axis].update(error, of_scans, share);
  }
  gyroscope.compare(contradicts, fused(3, 3) > 0);
  conflict += conflict_share * ((contradicts ? 1 : 0) - conflict);
  if (fused(3, 3) <= 0)
  {
    const double of_scans = measured.bottomRightCorner<3, 3>().diagonal().cwiseInverse().sum();
    evidence.add(sensed.mean_rate - biasVector(), logSO3(T_found.linear()) / dt,
                 of_scans / squared(dt));
    in_degrees = in_degrees || evidence.isOfDegrees();
  }
  const bool trusted = trusts_gyroscope || !options.gyroscope_check || evidence.fits();
  if (trusts_gyroscope && conflict > max_conflict)
  {
    evidence = {};
  }
  trusts_gyroscope = trusted && conflict <= max_conflict && !in_degrees;
}

/** \param sensed,found displacements [m] \param fused,measured their information [1/m^2] */
void MotionSensors::State::compareDisplacement(
    double sensed, double fused, double dt, double found, double measured)
{
  wheels.compare(fused <= 0, fused > 0);
  const auto error = errorAgainstScans(sensed - found, fused, measured);
  if (!error || std::abs(sensed - *error) < min_displacement)
  {
    return;
  }
  const double by_scans = sensed - *error;
  const double ratio = (1 + scale.value) * sensed / by_scans - 1;
  const double variance =
      (1 / measured + squared(found_sigma) + squared(options.wheel_sigma * dt)) / squared(by_scans);
  if (!scale.contradicts(ratio, variance))
  {
    scale.update(ratio, variance, least_variance * squared(options.wheel_scale_sigma));
  }
}

std::string MotionSensors::name() const
{
  const SensorUse& gyroscope = state_->gyroscope;
  const bool is_used = gyroscope.covered > 0 && state_->trusts_gyroscope;
  return std::string(is_used || gyroscope.compared > gyroscope.unused ? " + gyroscope" : "") +
         (state_->wheels.covered > 0 ? " + wheel_odometry" : "");
}

std::vector<std::string> MotionSensors::warnings() const
{
  std::vector<std::string> warnings;
  if (state_->in_degrees)
  {
    warnings.push_back(
        formatted("the gyroscope is not used: its angular velocities are %.0f times those of the "
                  "scans, so that they are in deg/s instead of rad/s; set "
                  "motion_sensors.gyroscope_unit=deg_s",
                  state_->evidence.ratio()));
  }
  else if (state_->gyroscope.compared == state_->gyroscope.unused && state_->evidence.showsTurns())
  {
    warnings.emplace_back(
        "the gyroscope is not used: its rotations are not those of the scans; check the IMU's pose "
        "on the vehicle (axes, direction), its clock and its units, or set "
        "motion_sensors.gyroscope=false");
  }
  else
  {
    state_->gyroscope.warn("gyroscope",
                           "the IMU's pose on the vehicle, its clock and its units, or set "
                           "motion_sensors.gyroscope=false",
                           warnings);
  }
  if (const std::optional<double> offset = state_->clock.offset())
  {
    warnings.push_back(formatted("the gyroscope's stamps are about %.2f s ", std::abs(*offset)) +
                       (*offset > 0 ? "late" : "early") +
                       " against those of the scans; synchronise the clocks when recording, or set "
                       "motion_sensors.gyroscope=false");
  }
  state_->wheels.warn("wheel odometry",
                      "its clock, units and direction, or set motion_sensors.wheel_odometry=false",
                      warnings);
  return warnings;
}

void MotionSensors::exchangeState(StateArchive& archive)
{
  State& s = *state_;
  archive(s.rates, s.speeds, s.bias, s.scale, s.trusts_gyroscope, s.conflict, s.evidence,
          s.in_degrees, s.gyroscope, s.wheels, s.clock);
}
}  // namespace dyslam
