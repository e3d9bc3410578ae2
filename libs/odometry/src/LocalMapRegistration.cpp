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
#include <utility>

#include "CloudCheck.h"
#include "CoarseToFine.h"
#include "FirstScan.h"
#include "ScanSample.h"
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

/** Some direction of motion is constrained less than by a standard deviation of `sigma` [m]. */
bool isDegenerate(const Matrix6& information, double sigma)
{
  Matrix6 scaled = information;
  scaled.bottomRows<3>() /= lever;
  scaled.rightCols<3>() /= lever;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] < 1 / square(sigma);
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
}  // namespace

struct LocalMapRegistration::State
{
  /** What later registrations need of earlier ones. */
  struct Progress
  {
    int failures = 0;                        //!< successive ones
    double guess_error2 = 0;                 //!< running mean square of the error of guesses [m^2]
    double usual_inliers = 0;                //!< running mean of the inlier share
    Pose T_odom_vehicle = Pose::Identity();  //!< of the last frame
  };
  /** Prior of a frame's pose, with its guess. */
  struct PosePrior
  {
    std::optional<Pose> T_odom_vehicle;           //!< the guess if there is none
    Matrix6 information = Matrix6::Zero();        //!< of the prior and the guess
    Matrix6 guess_information = Matrix6::Zero();  //!< of a guess that is not the prior
  };

  State(const RefineOptions& o, ThreadPool& p)
      : options(o), pool(p), map(o.cell_size, o.levels, o.max_points_per_cell, p), aligner(o, p)
  {
  }

  [[nodiscard]] PosePrior posePrior(const Pose& T_guess, const MotionPrior* prior) const;
  [[nodiscard]] std::vector<Eigen::Matrix3f> covariancesOf(const ScanSample& points) const;
  [[nodiscard]] ScanToMapSettings settings(const Frame& frame, const PosePrior& prior) const;
  void registerToMap(const Frame& frame,
                     const Pose& T_guess,
                     const PosePrior& prior,
                     double guess_error,
                     Addition& addition,
                     RegistrationResult& result);
  [[nodiscard]] ScanToMapResult alignSecond(const AlignmentProblem& problem,
                                            const Pose& T_guess,
                                            double guess_error,
                                            Addition& addition);
  /** Keeps the guess. \param reason failureReason() */
  void reject(const std::string& reason, Addition& addition, RegistrationResult& result) const;
  void accept(const ScanToMapResult& found,
              const PosePrior& prior,
              Addition& addition,
              RegistrationResult& result) const;
  void measureSensor(const Scan& scan);
  /** Starts the map anew from `points`. */
  void restart(const Frame& frame);
  /** Adds `points`, deskewed, at the pose of the last frame. */
  void add();
  /** Deskews `points` and adds them in a thread beside the caller, if the pool has more than one.
   * \param T_odom_previous of the frame before */
  void startAdding(const Pose& T_odom_previous);
  /** Waits for startAdding(): before anything else that uses the map, its frames or `points`. */
  void finishAdding();

  RefineOptions options;
  ThreadPool& pool;
  SurfacePyramid map;
  CoarseToFine aligner;
  Eigen::Vector3d cropped_at = Eigen::Vector3d::Zero();
  double spacing = 0;    //!< of the sensor's rings [rad]
  double cell_size = 0;  //!< of the map [m]
  int levels = 1;        //!< of the map
  int frames = 0;        //!< in the map
  FirstScan first;       //!< until the second one is added
  Progress progress;
  ScanSample points;  //!< of the frame that is being added; then memory for the next one's

  std::future<void> adding;  //!< last: its thread uses the others
};

/** What commit() does with a frame. */
struct LocalMapRegistration::Addition
{
  State::Progress progress;                 //!< after this frame
  bool restarts = false;                    //!< the map starts anew from it
  Pose T_odom_previous = Pose::Identity();  //!< of the frame before
  double dt = 0;                            //!< since that frame [s]
  std::optional<Pose> T_first_sweep;        //!< deskews the map's first scan anew, if set
  ScanSample points;
};

/** \param prior of the motion since the last frame; null: the guess is the prior */
LocalMapRegistration::State::PosePrior LocalMapRegistration::State::posePrior(
    const Pose& T_guess, const MotionPrior* prior) const
{
  const Matrix6 of_guess = informationFromSigmas(options.guess_sigma, options.guess_sigma_angle);
  PosePrior result;
  result.information = of_guess;
  if (prior == nullptr)
  {
    return result;
  }
  MotionPrior fused = *prior;
  const Pose guess = progress.T_odom_vehicle.inverse() * T_guess;
  if (logSE3(fused.T_previous_current.inverse() * guess).norm() > same_pose)
  {
    result.guess_information = of_guess;
    fused.fuse(guess, of_guess);
  }
  result.T_odom_vehicle = progress.T_odom_vehicle * fused.T_previous_current;
  result.information = fused.information;
  return result;
}

/** Of the sample's surroundings in its own scan; none for point to plane. */
std::vector<Eigen::Matrix3f> LocalMapRegistration::State::covariancesOf(
    const ScanSample& sampled) const
{
  std::vector<Eigen::Matrix3f> covariances;
  if (options.method != RefineMethod::gicp)
  {
    return covariances;
  }
  SurfaceMap own(cell_size, options.max_points_per_cell, pool);
  own.add(sampled.deskewed, sampled.scan.weight, Pose::Identity());
  covariances.resize(sampled.sample.size());
  pool.forChunks(covariances.size(), 512,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     covariances[i] =
                         own.surfaceAt(sampled.sample_deskewed[i], VoxelCell()).covariance;
                   }
                 });
  return covariances;
}

ScanToMapSettings LocalMapRegistration::State::settings(const Frame& frame,
                                                        const PosePrior& prior) const
{
  ScanToMapSettings s;
  s.distributions = options.method == RefineMethod::gicp;
  s.loss_width = options.loss_width;
  s.max_iterations = options.max_iterations;
  s.points_per_measurement = options.points_per_measurement;
  s.sensor = frame.scan.T_vehicle_lidar.translation();
  s.min_incidence = map.levels() > 1 ? options.min_incidence * spacing : 0;
  s.max_ground_weight_ratio = options.max_ground_weight_ratio;
  s.T_prior = prior.T_odom_vehicle;
  s.prior_information = prior.information;
  return s;
}

/** \param guess_error expected error of the guess [m]
 * \param result filled, its motion with the guess */
void LocalMapRegistration::State::registerToMap(const Frame& frame,
                                                const Pose& T_guess,
                                                const PosePrior& prior,
                                                double guess_error,
                                                Addition& addition,
                                                RegistrationResult& result)
{
  addition.points.draw(map.levels() > 1 ? options.sparse_sample_size : options.sample_size,
                       static_cast<std::size_t>(options.max_points));
  const std::vector<Eigen::Matrix3f> covariances = covariancesOf(addition.points);
  const AlignmentProblem problem{addition.points.sample, covariances, progress.T_odom_vehicle,
                                 settings(frame, prior)};
  const ScanToMapResult found =
      frames == 1 ? alignSecond(problem, T_guess, guess_error, addition)
                  : aligner.align(problem, map, T_guess, guess_error, progress.usual_inliers);
  result.points = addition.points.sample.size();
  result.loss_width = aligner.startLossWidth(guess_error);
  copyStatistics(found, result);
  const std::string reason = failureReason(found, options);
  if (reason.empty())
  {
    accept(found, prior, addition, result);
  }
  else
  {
    reject(reason, addition, result);
  }
}

/** The motion to the second frame also deskews the first: both are corrected in turn, in a map of
 * their own. */
ScanToMapResult LocalMapRegistration::State::alignSecond(const AlignmentProblem& problem,
                                                         const Pose& T_guess,
                                                         double guess_error,
                                                         Addition& addition)
{
  ScanToMapResult result =
      aligner.align(problem, map, T_guess, guess_error, progress.usual_inliers);
  if (!first.isSkewed())
  {
    return result;
  }
  FirstScan deskewed = first;
  deskewed.setSweepDuration(addition.dt);
  SurfacePyramid own_map(cell_size, levels, options.max_points_per_cell, pool);
  for (int round = 0; round < 2; ++round)
  {
    addition.T_first_sweep = problem.T_odom_previous.inverse() * result.T;
    deskewed.fill(own_map, *addition.T_first_sweep, pool);
    const int iterations = result.iterations;
    result = aligner.alignFine(problem, own_map, result.T, options.max_loss_width);
    result.iterations += iterations;
  }
  return result;
}

void LocalMapRegistration::State::reject(const std::string& reason,
                                         Addition& addition,
                                         RegistrationResult& result) const
{
  if (addition.T_first_sweep)
  {
    addition.T_first_sweep = result.motion.T_previous_current;
  }
  const bool poor_first =
      frames == 1 && first.size() < addition.points.scan.size() / poor_first_ratio;
  result.motion.reason = poor_first
                             ? "the local map has one scan of " + std::to_string(first.size()) +
                                   " points only, a part of a revolution"
                             : reason;
  if (++addition.progress.failures >= max_failures || poor_first)
  {
    addition.restarts = true;
    result.motion.map_restarted = true;
    result.motion.reason += "; the map is restarted";
  }
}

/** \pre the progress of the addition has the guess */
void LocalMapRegistration::State::accept(const ScanToMapResult& found,
                                         const PosePrior& prior,
                                         Addition& addition,
                                         RegistrationResult& result) const
{
  Progress& after = addition.progress;
  after.failures = 0;
  const double error2 = square(sizeOf(after.T_odom_vehicle.inverse() * found.T));
  after.guess_error2 = frames == 1 ? 0 : 0.8 * after.guess_error2 + 0.2 * error2;
  after.usual_inliers =
      frames == 1 ? found.inlier_share : 0.9 * after.usual_inliers + 0.1 * found.inlier_share;
  after.T_odom_vehicle = found.T;

  result.degenerate = isDegenerate(found.information, options.guess_sigma);
  result.measured_information = found.information + prior.guess_information;
  result.prior_weight = found.prior_weight;
  result.motion.information += found.information;
  result.motion.status = found.converged ? MotionStatus::converged : MotionStatus::not_settled;
  result.motion.reason = found.converged ? "" : "the registration did not converge";
  result.motion.T_previous_current = orthonormalized(addition.T_odom_previous.inverse() * found.T);
  result.T_odom_vehicle = found.T;
}

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

void LocalMapRegistration::State::restart(const Frame& frame)
{
  measureSensor(frame.scan);
  map.restart(cell_size, levels);
  frames = 0;
  progress.failures = 0;
  first = FirstScan(points.scan, progress.T_odom_vehicle);
  add();
}

void LocalMapRegistration::State::add()
{
  const Pose& T = progress.T_odom_vehicle;
  map.add(points.deskewed, points.scan.weight, T);
  ++frames;
  if ((T.translation() - cropped_at).norm() > crop_share * options.map_radius)
  {
    map.crop(T.translation(), options.map_radius);
    cropped_at = T.translation();
  }
}

void LocalMapRegistration::State::startAdding(const Pose& T_odom_previous)
{
  const auto job = [this, T_sweep = Pose(T_odom_previous.inverse() * progress.T_odom_vehicle)]
  {
    points.scan.deskewed(T_sweep, pool, points.deskewed);
    add();
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

LocalMapRegistration::Alignment::Alignment() = default;
LocalMapRegistration::Alignment::~Alignment() = default;
LocalMapRegistration::Alignment::Alignment(Alignment&&) noexcept = default;
LocalMapRegistration::Alignment& LocalMapRegistration::Alignment::operator=(Alignment&&) noexcept =
    default;

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

LocalMapRegistration::Alignment LocalMapRegistration::align(
    const Frame& frame,
    const Pose& T_odom_vehicle_guess,
    const MotionPrior* prior,
    std::optional<double> initial_sigma) const
{
  State& s = *state_;
  s.finishAdding();
  Alignment alignment;
  alignment.addition_ = std::make_unique<Addition>();
  Addition& addition = *alignment.addition_;
  RegistrationResult& result = alignment.result_;
  const Pose T_guess = orthonormalized(T_odom_vehicle_guess);
  addition.points = std::move(s.points);
  addition.progress = s.progress;
  addition.progress.T_odom_vehicle = T_guess;
  addition.T_odom_previous = s.progress.T_odom_vehicle;
  addition.dt = frame.dt;

  const State::PosePrior pose_prior = s.posePrior(T_guess, prior);
  result.T_odom_vehicle = T_guess;
  result.motion.T_previous_current = orthonormalized(addition.T_odom_previous.inverse() * T_guess);
  result.motion.information = pose_prior.information;
  setReasonUnusable(frame, result.motion);
  if (!result.motion.reason.empty())
  {
    return alignment;
  }
  addition.points.ingest(frame, s.options.map_spacing, s.pool);
  if (s.frames == 0)
  {
    addition.restarts = true;
    result.motion.status = MotionStatus::converged;
    return alignment;
  }
  const double guess_error = s.frames == 1 ? initial_sigma.value_or(s.options.initial_sigma)
                                           : std::sqrt(s.progress.guess_error2);
  s.registerToMap(frame, T_guess, pose_prior, guess_error, addition, result);
  return alignment;
}

void LocalMapRegistration::commit(Alignment alignment, const Frame& frame)
{
  if (!alignment.addition_)
  {
    throw std::logic_error("LocalMapRegistration::commit: the alignment is of no frame");
  }
  State& s = *state_;
  s.finishAdding();
  Addition& addition = *alignment.addition_;
  s.progress = addition.progress;
  s.points = std::move(addition.points);
  if (addition.restarts)
  {
    s.points.updateWeights(frame);
    s.restart(frame);
    return;
  }
  if (addition.T_first_sweep)
  {
    s.first.setSweepDuration(addition.dt);
    s.first.fill(s.map, *addition.T_first_sweep, s.pool);
  }
  if (alignment.result_.motion.registered())
  {
    s.points.updateWeights(frame);
    s.first.clear();
    s.startAdding(addition.T_odom_previous);
  }
}

int LocalMapRegistration::framesInMap() const
{
  state_->finishAdding();
  return state_->frames;
}

const Pose& LocalMapRegistration::pose() const
{
  return state_->progress.T_odom_vehicle;
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
  archive(s.map, s.cropped_at, s.spacing, s.cell_size, s.levels, s.frames, s.progress, s.first);
}
}  // namespace dyslam
