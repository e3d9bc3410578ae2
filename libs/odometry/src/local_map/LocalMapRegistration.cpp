// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/LocalMapRegistration.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "CoarseToFine.h"
#include "LocalMap.h"
#include "RegistrationQuality.h"
#include "ScanSample.h"
#include "SurfacePyramid.h"
#include "matchers/CloudCheck.h"
#include "scans/FirstScan.h"

namespace dyslam
{
namespace
{
/** Frames in a row that must fail before the map is restarted. */
constexpr int max_failed_frames = 5;
/** The first scan of a map is replaced at once if the next has so many times its points. */
constexpr std::size_t poor_first_ratio = 3;
/** A guess nearer to the prior counts as the prior. */
constexpr double same_pose = 1e-9;

void copyStatistics(const ScanToMapResult& found, RegistrationResult& result)
{
  result.inlier_share = found.inlier_share;
  result.surface_share = found.surface_share;
  result.inlier_ratio = found.inlier_ratio;
  result.motion.iterations = found.iterations;
  result.motion.inliers = found.inliers;
  result.motion.rmse = found.rmse;
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
    Pose T_odom_vehicle = Pose::Identity();  //!< pose of the last frame
  };
  /** Prior of a frame's pose, with its guess. */
  struct PosePrior
  {
    std::optional<Pose> T_odom_vehicle;           //!< the guess if there is none
    Matrix6 information = Matrix6::Zero();        //!< sum for prior and guess
    Matrix6 guess_information = Matrix6::Zero();  //!< part of a guess that differs from it
  };

  State(const RefineOptions& o, ThreadPool& p) : options(o), pool(p), map(o, p), aligner(o, p) {}

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

  RefineOptions options;
  ThreadPool& pool;
  LocalMap map;
  CoarseToFine aligner;
  Progress progress;
};

/** What commit() does with a frame. */
struct LocalMapRegistration::Addition
{
  State::Progress progress;                 //!< after this frame
  bool restarts = false;                    //!< the map starts anew from it
  Pose T_odom_previous = Pose::Identity();  //!< pose of the frame before
  double dt = 0;                            //!< time since that frame [s]
  std::optional<Pose> T_first_sweep;        //!< deskews the map's first scan anew, if set
  ScanSample points;
};

/** \param prior of the motion since the last frame; null: the guess is the prior */
LocalMapRegistration::State::PosePrior LocalMapRegistration::State::posePrior(
    const Pose& T_guess, const MotionPrior* prior) const
{
  const Matrix6 of_guess = informationFromSigmas(options.guess_sigma, options.guess_sigma_rotation);
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

/** Covariances of the surfaces around the sampled points, from their own scan [m^2]; empty for
 * point to plane. */
std::vector<Eigen::Matrix3f> LocalMapRegistration::State::covariancesOf(
    const ScanSample& sampled) const
{
  std::vector<Eigen::Matrix3f> covariances;
  if (options.method != RefineMethod::gicp)
  {
    return covariances;
  }
  SurfaceMap own(map.cellSize(), options.max_points_per_cell, pool);
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
  s.lidars.clear();
  for (const LidarRange& lidar : lidarRanges(frame.scan, frame.cloud))
  {
    s.lidars.push_back(lidar.sensor());
  }
  s.min_incidence = map.surfaces().levels() > 1 ? options.min_incidence * map.ringSpacing() : 0;
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
  addition.points.draw(
      map.surfaces().levels() > 1 ? options.sparse_sample_size : options.sample_size,
      static_cast<std::size_t>(options.max_points));
  const std::vector<Eigen::Matrix3f> covariances = covariancesOf(addition.points);
  const AlignmentProblem problem{addition.points.sample, covariances, progress.T_odom_vehicle,
                                 settings(frame, prior)};
  const ScanToMapResult found =
      map.scans() == 1
          ? alignSecond(problem, T_guess, guess_error, addition)
          : aligner.align(problem, map.surfaces(), T_guess, guess_error, progress.usual_inliers);
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
      aligner.align(problem, map.surfaces(), T_guess, guess_error, progress.usual_inliers);
  if (!map.first().isSkewed())
  {
    return result;
  }
  FirstScan first = map.first();
  first.setSweepDuration(addition.dt);
  SurfacePyramid own_map = map.emptySurfaces();
  for (int round = 0; round < 2; ++round)
  {
    addition.T_first_sweep = problem.T_odom_previous.inverse() * result.T;
    first.fill(own_map, *addition.T_first_sweep, pool);
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
  const std::size_t in_first = map.first().size();
  const bool poor_first =
      map.scans() == 1 && in_first < addition.points.scan.size() / poor_first_ratio;
  result.motion.reason = poor_first ? "the local map has one scan of " + std::to_string(in_first) +
                                          " points only, a part of a revolution"
                                    : reason;
  if (++addition.progress.failures >= max_failed_frames || poor_first)
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
  const bool first_in_map = map.scans() == 1;
  Progress& after = addition.progress;
  after.failures = 0;
  const double error = poseDistance(after.T_odom_vehicle, found.T);
  after.guess_error2 = first_in_map ? 0 : 0.8 * after.guess_error2 + 0.2 * (error * error);
  after.usual_inliers =
      first_in_map ? found.inlier_share : 0.9 * after.usual_inliers + 0.1 * found.inlier_share;
  after.T_odom_vehicle = found.T;

  result.degenerate = isDegenerate(found.information, options.guess_sigma);
  result.measured_information = found.information + prior.guess_information;
  result.prior_weight = found.prior_weight;
  result.motion.information += found.information;
  result.motion.status = found.converged ? MotionStatus::converged : MotionStatus::not_settled;
  result.motion.reason = found.converged ? "" : "the registration did not converge";
  result.motion.T_previous_current = orthonormalised(addition.T_odom_previous.inverse() * found.T);
  result.T_odom_vehicle = found.T;
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

LocalMapRegistration::Alignment LocalMapRegistration::align(const Frame& frame,
                                                            const Pose& T_odom_vehicle_guess,
                                                            const MotionPrior* prior,
                                                            std::optional<double> initial_sigma)
{
  State& s = *state_;
  Alignment alignment;
  alignment.addition_ = std::make_unique<Addition>();
  Addition& addition = *alignment.addition_;
  RegistrationResult& result = alignment.result_;
  const Pose T_guess = orthonormalised(T_odom_vehicle_guess);
  addition.points = s.map.takeMemory();
  addition.progress = s.progress;
  addition.progress.T_odom_vehicle = T_guess;
  addition.T_odom_previous = s.progress.T_odom_vehicle;
  addition.dt = frame.dt;

  const State::PosePrior pose_prior = s.posePrior(T_guess, prior);
  result.T_odom_vehicle = T_guess;
  result.motion.T_previous_current = orthonormalised(addition.T_odom_previous.inverse() * T_guess);
  result.motion.information = pose_prior.information;
  setReasonUnusable(frame, result.motion);
  if (!result.motion.reason.empty())
  {
    // No points have measured the guess.
    result.motion.information = prior != nullptr ? prior->information : pose_prior.information;
    return alignment;
  }
  addition.points.ingest(frame, s.options.map_spacing, s.pool);
  if (s.map.scans() == 0)
  {
    addition.restarts = true;
    result.motion.status = MotionStatus::converged;
    return alignment;
  }
  const double guess_error = s.map.scans() == 1 ? initial_sigma.value_or(s.options.initial_sigma)
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
  Addition& addition = *alignment.addition_;
  s.progress = addition.progress;
  const Pose& T_odom_vehicle = s.progress.T_odom_vehicle;
  if (addition.restarts)
  {
    s.progress.failures = 0;
    addition.points.updateWeights(frame);
    s.map.restart(frame.scan, std::move(addition.points), T_odom_vehicle);
    return;
  }
  if (addition.T_first_sweep)
  {
    s.map.deskewFirst(*addition.T_first_sweep, addition.dt);
  }
  if (alignment.result_.motion.registered())
  {
    addition.points.updateWeights(frame);
    s.map.add(std::move(addition.points), addition.T_odom_previous.inverse() * T_odom_vehicle,
              T_odom_vehicle);
  }
}

int LocalMapRegistration::framesInMap() const
{
  return state_->map.scans();
}

double LocalMapRegistration::usualInlierShare() const
{
  return state_->progress.usual_inliers;
}

const Pose& LocalMapRegistration::pose() const
{
  return state_->progress.T_odom_vehicle;
}

std::vector<Eigen::Vector3f> LocalMapRegistration::mapPoints() const
{
  return state_->map.surfaces().means();
}

void LocalMapRegistration::exchangeState(StateArchive& archive)
{
  archive(state_->map, state_->progress);
}
}  // namespace dyslam
