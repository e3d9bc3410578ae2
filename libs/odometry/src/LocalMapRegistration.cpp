// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/ScanPattern.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/odometry/LocalMapRegistration.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <stdexcept>
#include <string>

#include "CloudCheck.h"
#include "ScanSample.h"
#include "ScanToMap.h"
#include "SurfacePyramid.h"

namespace dyslam
{
namespace
{
/** Frames in a row that must fail before the map is restarted. */
constexpr int max_failures = 5;
/** The first scan of a map is replaced at once if the next has so many times its points. */
constexpr std::size_t poor_first_ratio = 3;
constexpr std::size_t min_inliers = 50;
/** Rotation weighs as the translation that it causes at this distance [m]. */
constexpr double lever = 10;
/** The map is cropped each time the vehicle has moved by this share of its radius. */
constexpr double crop_share = 0.1;
/** A guess nearer to the prior counts as the prior. */
constexpr double same_pose = 1e-9;
/** Share of the usual inliers below which the registration is repeated coarse to fine. */
constexpr double poor_inliers = 0.7;
constexpr int max_coarseness = 8;  //!< of the map's cells
/** The smallest cells are no smaller than the rings are apart at this distance [m]; the largest
 * ones are as large as at more than twice of it. */
constexpr double single_ring_range = 17;
constexpr double several_rings_range = 37.5;

double square(double x)
{
  return x * x;
}

double sizeOf(const Pose& T)
{
  return T.translation().norm() + lever * rotationAngle(T);
}

void copyStatistics(const ScanToMapResult& found, RegistrationResult& result)
{
  result.inlier_share = found.inlier_share;
  result.surface_share = found.surface_share;
  result.inlier_ratio = found.inlier_ratio;
  result.motion.iterations = found.iterations;
  result.motion.inliers = found.inliers;
  result.motion.rmse = found.rmse;
}

/** What is wrong with a registration, as a sentence; empty if it may be accepted. Values are
 * rounded down, so that none reads as its limit. */
std::string failureReason(const ScanToMapResult& found, const RefineOptions& options)
{
  char text[240];
  if (!found.finite)
  {
    return "the registration has no finite solution";
  }
  if (found.surface_share < options.min_surface_share)
  {
    std::snprintf(text, sizeof text,
                  "%.0f %% of the points have a surface in the local map, the limit is %g %% "
                  "(refine.min_surface_share): the map's cells are too small for the sensor, raise "
                  "refine.levels or refine.cell_size",
                  std::floor(100 * found.surface_share), 100 * options.min_surface_share);
    return text;
  }
  if (found.inliers < min_inliers)
  {
    std::snprintf(text, sizeof text,
                  "the scan does not fit the local map: %zu inliers, the limit is %zu",
                  found.inliers, min_inliers);
    return text;
  }
  if (found.inlier_ratio < options.min_inlier_ratio)
  {
    std::snprintf(text, sizeof text,
                  "the scan does not fit the local map: inlier ratio %.2f, the limit is %g "
                  "(refine.min_inlier_ratio)",
                  std::floor(100 * found.inlier_ratio) / 100, options.min_inlier_ratio);
    return text;
  }
  return {};
}

/** What integrate() does with the frame registered last. */
enum class Pending
{
  nothing,
  add,
  restart
};
}  // namespace

/** What the registration of a frame changes for later ones; tryFrame() restores it. */
struct RegistrationProgress
{
  int failures = 0;                         //!< successive ones
  double guess_error2 = 0;                  //!< running mean square of the error of guesses [m^2]
  double usual_inliers = 0;                 //!< running mean of the inlier share
  Pose T_odom_previous = Pose::Identity();  //!< of the frame before the current one
  Pose T_odom_vehicle = Pose::Identity();   //!< of the current frame
};

struct LocalMapRegistration::State : RegistrationProgress
{
  State(const RefineOptions& o, ThreadPool& p)
      : options(o), pool(p), map(o.cell_size, o.levels, o.max_points_per_cell, p), registration(p)
  {
  }

  void measureSensor(const Scan& scan);
  void setPrior(const Pose& T_guess, const MotionPrior* prior);
  void computeCovariances();
  [[nodiscard]] ScanToMapSettings settings(double start_loss_width) const;
  ScanToMapResult alignCoarseToFine(const Pose& T_guess, int coarseness);
  ScanToMapResult align(const Pose& T_guess, double guess_error);
  ScanToMapResult alignSecond(const Pose& T_guess, double guess_error, double dt);
  /** The map of the first frame anew, deskewed by the motion of its sweep. */
  void rebuildFromFirst(const Pose& T_sweep);
  /** Keeps the guess. \param reason failureReason() */
  void fail(const std::string& reason, RegistrationResult& result);
  void succeed(const Pose& T_guess, const ScanToMapResult& found, RegistrationResult& result);
  void add(const std::vector<Eigen::Vector3f>& points, const Pose& T);
  /** Starts adding the current frame to the map in a thread beside the caller, if the pool has more
   * than one. */
  void startAdding();
  /** Waits for startAdding(): before anything else that uses the map or the current frame. */
  void finishAdding();

  RefineOptions options;
  ThreadPool& pool;
  SurfacePyramid map;
  ScanToMap registration;
  Eigen::Vector3d cropped_at = Eigen::Vector3d::Zero();
  double spacing = 0;                    //!< of the sensor's rings [rad]
  double cell_size = 0;                  //!< of the map [m]
  int levels = 1;                        //!< of the map
  int frames = 0;                        //!< in the map
  RawPoints first;                       //!< the first frame, until the second shows its motion
  Pose T_odom_first = Pose::Identity();  //!< where it was

  // The current frame
  RegistrationProgress before;  //!< it was registered
  Pending pending = Pending::nothing;
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  //!< vehicle frame [m]
  std::optional<Pose> T_prior;
  Matrix6 prior_information = Matrix6::Zero();  //!< of the prior and the guess
  Matrix6 guess_information = Matrix6::Zero();  //!< of a guess that is not the prior
  ScanSample points;
  std::vector<Eigen::Matrix3f> covariances;  //!< of the sample's surroundings in its own scan

  std::future<void> adding;  //!< last: its thread uses the others
};

/** The map's resolution for the sensor of this scan. */
void LocalMapRegistration::State::measureSensor(const Scan& scan)
{
  spacing = measureScanPattern(scan).spacing();
  cell_size = std::max(options.cell_size, single_ring_range * spacing);
  levels = options.levels > 0 ? options.levels : 1;
  if (options.levels == 0)
  {
    for (double size = cell_size;
         levels < SurfacePyramid::max_levels && size < several_rings_range * spacing; size *= 2)
    {
      ++levels;
    }
  }
}

void LocalMapRegistration::State::setPrior(const Pose& T_guess, const MotionPrior* prior)
{
  const Matrix6 of_guess = informationFromSigmas(options.guess_sigma, options.guess_sigma_angle);
  guess_information.setZero();
  T_prior.reset();
  prior_information = of_guess;
  if (prior == nullptr)
  {
    return;
  }
  MotionPrior fused = *prior;
  const Pose guess = T_odom_previous.inverse() * T_guess;
  if (logSE3(fused.T_previous_current.inverse() * guess).norm() > same_pose)
  {
    guess_information = of_guess;
    fused.fuse(guess, of_guess);
  }
  T_prior = T_odom_previous * fused.T_previous_current;
  prior_information = fused.information;
}

void LocalMapRegistration::State::computeCovariances()
{
  covariances.clear();
  if (options.method != RefineMethod::gicp)
  {
    return;
  }
  SurfaceMap own(cell_size, options.max_points_per_cell, pool);
  own.add(points.deskewed, points.scan.weight, Pose::Identity());
  covariances.resize(points.sample.size());
  pool.forChunks(covariances.size(), 512,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     covariances[i] =
                         own.surfaceAt(points.sample_deskewed[i], VoxelCell()).covariance;
                   }
                 });
}

ScanToMapSettings LocalMapRegistration::State::settings(double start_loss_width) const
{
  ScanToMapSettings s;
  s.distributions = options.method == RefineMethod::gicp;
  s.loss_width = options.loss_width;
  s.start_loss_width = std::clamp(start_loss_width, options.loss_width, options.max_loss_width);
  s.max_iterations = options.max_iterations;
  s.points_per_measurement = options.points_per_measurement;
  s.sensor = sensor;
  s.min_incidence = map.levels() > 1 ? options.min_incidence * spacing : 0;
  s.max_ground_weight_ratio = options.max_ground_weight_ratio;
  s.T_prior = T_prior;
  s.prior_information = prior_information;
  return s;
}

/** First to the map in cells `coarseness` times as large, then halved step by step. */
ScanToMapResult LocalMapRegistration::State::alignCoarseToFine(const Pose& T_guess, int coarseness)
{
  Pose T = T_guess;
  int iterations = 0;
  for (; coarseness > 1; coarseness /= 2)
  {
    const SurfacePyramid coarse = map.coarser(coarseness);
    ScanToMapSettings s = settings(0);
    s.distributions = false;
    s.start_loss_width = static_cast<double>(map.cellSize()) * coarseness;
    s.loss_width = options.loss_width * coarseness;
    s.prior_information /= static_cast<double>(coarseness * coarseness);
    const ScanToMapResult level =
        registration.align(points.sample, covariances, coarse, T_odom_previous, T, s);
    T = level.T;
    iterations += level.iterations;
  }
  ScanToMapResult fine = registration.align(points.sample, covariances, map, T_odom_previous, T,
                                            settings(options.max_loss_width));
  fine.iterations += iterations;
  return fine;
}

/** Coarse to fine where the error of the guess may be larger than the map's cells. */
ScanToMapResult LocalMapRegistration::State::align(const Pose& T_guess, double guess_error)
{
  int coarseness = 1;
  while (coarseness < max_coarseness &&
         guess_error > static_cast<double>(map.cellSize()) * coarseness)
  {
    coarseness *= 2;
  }
  if (coarseness > 1)
  {
    return alignCoarseToFine(T_guess, coarseness);
  }
  ScanToMapResult result = registration.align(points.sample, covariances, map, T_odom_previous,
                                              T_guess, settings(guess_error));
  if (result.inlier_share < poor_inliers * usual_inliers)
  {
    const ScanToMapResult second = alignCoarseToFine(T_guess, 4);
    if (second.inlier_share > result.inlier_share)
    {
      result = second;
    }
  }
  return result;
}

void LocalMapRegistration::State::rebuildFromFirst(const Pose& T_sweep)
{
  std::vector<Eigen::Vector3f> deskewed;
  first.deskewed(T_sweep, pool, deskewed);
  map.clear();
  map.add(deskewed, first.weight, T_odom_first);
}

/** The motion to the second frame also deskews the first: both are corrected in turn. */
ScanToMapResult LocalMapRegistration::State::alignSecond(const Pose& T_guess,
                                                         double guess_error,
                                                         double dt)
{
  ScanToMapResult result = align(T_guess, guess_error);
  if (first.phase.empty())
  {
    return result;
  }
  first.rescalePhase(dt);
  for (int round = 0; round < 2; ++round)
  {
    rebuildFromFirst(T_odom_previous.inverse() * result.T);
    const int iterations = result.iterations;
    result = registration.align(points.sample, covariances, map, T_odom_previous, result.T,
                                settings(options.max_loss_width));
    result.iterations += iterations;
  }
  return result;
}

void LocalMapRegistration::State::fail(const std::string& reason, RegistrationResult& result)
{
  if (frames == 1 && !first.phase.empty())
  {
    // The rejected motion has deskewed it.
    rebuildFromFirst(result.motion.T_previous_current);
  }
  const bool poor_first = frames == 1 && first.size() < points.scan.size() / poor_first_ratio;
  result.motion.reason = poor_first
                             ? "the local map has one scan of " + std::to_string(first.size()) +
                                   " points only, a part of a revolution"
                             : reason;
  if (++failures >= max_failures || poor_first)
  {
    pending = Pending::restart;
    result.motion.map_restarted = true;
    result.motion.reason += "; the map is restarted";
  }
}

void LocalMapRegistration::State::succeed(const Pose& T_guess,
                                          const ScanToMapResult& found,
                                          RegistrationResult& result)
{
  failures = 0;
  const double error2 = square(sizeOf(T_guess.inverse() * found.T));
  guess_error2 = frames == 1 ? 0 : 0.8 * guess_error2 + 0.2 * error2;
  usual_inliers = frames == 1 ? found.inlier_share : 0.9 * usual_inliers + 0.1 * found.inlier_share;

  Matrix6 scaled = found.information;
  scaled.bottomRows<3>() /= lever;
  scaled.rightCols<3>() /= lever;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled, Eigen::EigenvaluesOnly);
  result.degenerate = solver.eigenvalues()[0] < 1 / square(options.guess_sigma);
  result.measured_information = found.information + guess_information;
  result.prior_weight = found.prior_weight;
  result.motion.information += found.information;
  result.motion.status = found.converged ? MotionStatus::converged : MotionStatus::not_settled;
  result.motion.reason = found.converged ? "" : "the registration did not converge";
  result.motion.T_previous_current = orthonormalized(T_odom_previous.inverse() * found.T);
  result.T_odom_vehicle = found.T;
  T_odom_vehicle = found.T;
  pending = Pending::add;
}

void LocalMapRegistration::State::add(const std::vector<Eigen::Vector3f>& deskewed, const Pose& T)
{
  map.add(deskewed, points.scan.weight, T);
  ++frames;
  if ((T.translation() - cropped_at).norm() > crop_share * options.map_radius)
  {
    map.crop(T.translation(), options.map_radius);
    cropped_at = T.translation();
  }
}

void LocalMapRegistration::State::startAdding()
{
  const auto job = [this]
  {
    const Pose T_sweep = T_odom_previous.inverse() * T_odom_vehicle;
    points.scan.deskewed(T_sweep, pool, points.deskewed);
    add(points.deskewed, T_odom_vehicle);
  };
  if (pool.size() > 1)
  {
    adding = std::async(std::launch::async, job);
  }
  else
  {
    job();
  }
}

void LocalMapRegistration::State::finishAdding()
{
  if (adding.valid())
  {
    adding.get();
  }
}

LocalMapRegistration::LocalMapRegistration(const RefineOptions& options, ThreadPool& pool)
{
  validate(options, "refine");
  if (options.loss_width > options.max_loss_width)
  {
    throw UserError(
        "[refine] loss_width: is above max_loss_width; lower loss_width or raise max_loss_width");
  }
  state_ = std::make_unique<State>(options, pool);
}
LocalMapRegistration::~LocalMapRegistration() = default;
LocalMapRegistration::LocalMapRegistration(LocalMapRegistration&&) noexcept = default;

RegistrationResult LocalMapRegistration::registerFrame(const Frame& frame,
                                                       const Pose& T_odom_vehicle_guess,
                                                       const MotionPrior* prior,
                                                       std::optional<double> initial_sigma)
{
  State& s = *state_;
  s.finishAdding();
  s.before = s;
  s.T_odom_previous = s.T_odom_vehicle;
  s.sensor = frame.scan.T_vehicle_lidar.translation();
  s.pending = Pending::nothing;
  const Pose T_guess = orthonormalized(T_odom_vehicle_guess);
  s.T_odom_vehicle = T_guess;
  RegistrationResult result;
  result.T_odom_vehicle = T_guess;
  result.motion = frame.odometry;
  result.motion.T_previous_current = orthonormalized(s.T_odom_previous.inverse() * T_guess);
  if (s.options.method == RefineMethod::none)
  {
    return result;
  }

  s.setPrior(T_guess, prior);
  result.motion = MotionEstimate();
  result.motion.T_previous_current = orthonormalized(s.T_odom_previous.inverse() * T_guess);
  result.motion.information = s.prior_information;
  setReasonUnusable(frame, result.motion);
  if (!result.motion.reason.empty())
  {
    return result;
  }
  s.points.ingest(frame, s.options.map_spacing, s.pool);
  if (s.frames == 0)
  {
    s.pending = Pending::restart;
    result.motion.status = MotionStatus::converged;
    return result;
  }
  s.points.draw(s.map.levels() > 1 ? s.options.sparse_sample_size : s.options.sample_size,
                static_cast<std::size_t>(s.options.max_points));
  s.computeCovariances();
  const double guess_error =
      s.frames == 1 ? initial_sigma.value_or(s.options.initial_sigma) : std::sqrt(s.guess_error2);
  const ScanToMapResult found =
      s.frames == 1 ? s.alignSecond(T_guess, guess_error, frame.dt) : s.align(T_guess, guess_error);
  result.points = s.points.sample.size();
  copyStatistics(found, result);
  result.loss_width = s.settings(guess_error).start_loss_width;
  const std::string reason = failureReason(found, s.options);
  if (reason.empty())
  {
    s.succeed(T_guess, found, result);
  }
  else
  {
    s.fail(reason, result);
  }
  return result;
}

RegistrationResult LocalMapRegistration::registerAgain(const Frame& frame,
                                                       const Pose& T_odom_vehicle_guess,
                                                       const MotionPrior* prior)
{
  static_cast<RegistrationProgress&>(*state_) = state_->before;
  return registerFrame(frame, T_odom_vehicle_guess, prior);
}

RegistrationResult LocalMapRegistration::tryFrame(const Frame& frame,
                                                  const Pose& T_odom_vehicle_guess,
                                                  const MotionPrior* prior)
{
  State& s = *state_;
  s.finishAdding();
  if (s.frames < 2)
  {
    throw std::logic_error("LocalMapRegistration::tryFrame: the map has fewer than two frames");
  }
  const RegistrationResult result = registerFrame(frame, T_odom_vehicle_guess, prior);
  static_cast<RegistrationProgress&>(s) = s.before;
  s.pending = Pending::nothing;
  return result;
}

void LocalMapRegistration::integrate(const Frame& frame)
{
  State& s = *state_;
  s.finishAdding();
  if (s.pending == Pending::nothing)
  {
    return;
  }
  s.points.updateWeights(frame);
  if (s.pending == Pending::restart)
  {
    s.measureSensor(frame.scan);
    s.map.restart(s.cell_size, s.levels);
    s.frames = 0;
    s.failures = 0;
    s.first = s.points.scan;
    s.T_odom_first = s.T_odom_vehicle;
    s.add(s.points.deskewed, s.T_odom_vehicle);
  }
  else
  {
    s.first.clear();
    s.startAdding();
  }
  s.pending = Pending::nothing;
}

int LocalMapRegistration::framesInMap() const
{
  state_->finishAdding();
  return state_->frames;
}

const Pose& LocalMapRegistration::pose() const
{
  return state_->T_odom_vehicle;
}

std::vector<Eigen::Vector3f> LocalMapRegistration::mapPoints() const
{
  state_->finishAdding();
  return state_->map.means();
}

void LocalMapRegistration::exchangeState(StateArchive& archive)
{
  State& s = *state_;
  s.finishAdding();
  archive(s.map, s.cropped_at, s.spacing, s.cell_size, s.levels, s.frames, s.failures,
          s.guess_error2, s.usual_inliers, s.first, s.T_odom_first, s.T_odom_previous,
          s.T_odom_vehicle, s.pending);
}
}  // namespace dyslam
