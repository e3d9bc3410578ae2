// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <dyslam/core/VoxelGrid.h>
#include <dyslam/odometry/LocalMapRefinement.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "ScanToMap.h"
#include "ScanToScan.h"
#include "SimpleOdometry.h"
#include "SurfaceMap.h"

namespace dyslam
{
namespace
{
/** Frames in a row that must fail before the map is begun anew. */
constexpr int patience = 5;
constexpr std::size_t fewest_inliers = 50;
/** Motion at which rotation and translation weigh the same in a deviation [m]. */
constexpr double lever = 10;
/** The map is cropped after this share of its radius. */
constexpr double crop_share = 0.1;
/** A guess nearer to the prior is the prior. */
constexpr double same_pose = 1e-9;

double square(double x)
{
  return x * x;
}

double deviation(const Pose& T)
{
  return T.translation().norm() + lever * rotationAngle(T);
}
}  // namespace

void RefineOptions::describe(OptionsVisitor& v)
{
  v.choice("method", method,
           {{"none", RefineMethod::none},
            {"point_to_plane", RefineMethod::point_to_plane},
            {"gicp", RefineMethod::gicp}},
           "registration to the local map");
  v.real("cell_size", cell_size, 0.05, 10, "side of the map's cells [m]");
  v.real("cell_points", cell_points, 6, 1e6, "a cell with this many points takes no more");
  v.real("map_spacing", map_spacing, 0, 10, "nearer followers along a ring are left out [m]");
  v.real("map_radius", map_radius, 5, 1000, "farther cells are dropped [m]");
  v.real("sample_size", sample_size, 0.05, 20, "registered points: one per cube of this side [m]");
  v.integer("max_points", max_points, 100, 1000000, "cap on registered points per scan");
  v.integer("max_iterations", max_iterations, 1, 200, "of the registration, per level");
  v.real("kernel", kernel, 0.001, 10, "scale of the robust kernel once the guess is good [m]");
  v.real("max_kernel", max_kernel, 0.001, 10, "its start where guesses have been bad [m]");
  v.real("start_deviation", start_deviation, 0, 50, "how wrong the first guess may be [m]");
  v.real("guess_sigma", guess_sigma, 1e-4, 1e3, "how far guesses are trusted: translation [m]");
  v.degrees("guess_sigma_angle_deg", guess_sigma_angle, 1e-3, 180, "... and rotation");
  v.real("odometry_trust", odometry_trust, 0, 10,
         "share of the odometry's own information that joins the guess");
  v.real("correlated_points", correlated_points, 1, 1e6, "points that count as one measurement");
  v.real("level_share", level_share, 1e-3, 1e9,
         "level surfaces count at most so many times as much as all others");
  v.real("min_inlier_share", min_inlier_share, 0, 1, "with less agreement the scan has failed");
}

void PosePrior::join(const Pose& T_measured, const Matrix6& measured)
{
  const Vector6 apart = logSE3(T_odom_vehicle.inverse() * T_measured);
  information += measured;
  T_odom_vehicle = T_odom_vehicle * expSE3(information.ldlt().solve(measured * apart));
}

double PosePrior::deviationsTo(const Pose& T_measured, double deviation, double turn) const
{
  Matrix6 covariance = information.llt().solve(Matrix6::Identity());
  covariance.diagonal().head<3>().array() += deviation * deviation;
  covariance.diagonal().tail<3>().array() += turn * turn;
  const Vector6 apart = logSE3(T_odom_vehicle.inverse() * T_measured);
  return std::sqrt(apart.dot(covariance.llt().solve(apart)));
}

struct LocalMapRefinement::State
{
  State(const RefineOptions& o, ThreadPool& p)
      : options(o), pool(p), map(o.cell_size, o.cell_points, p), registration(p)
  {
  }

  void setPrior(const Frame& frame, const Pose& T_guess, const PosePrior* prior);
  void takeIn(const Frame& frame);
  void sampleScan();
  void shapeSample();
  [[nodiscard]] ScanToMapSettings settings(double start_kernel) const;
  ScanToMapResult registerScan(const Pose& T_before, const Pose& T_guess);
  ScanToMapResult registerSecond(const Pose& T_before, const Pose& T_guess);
  void join(const Pose& T_before, const Pose& T);

  RefineOptions options;
  ThreadPool& pool;
  SurfaceMap map;
  ScanToMap registration;
  Pose T_odom_vehicle = Pose::Identity();
  Eigen::Vector3d cropped_at = Eigen::Vector3d::Zero();
  int joined = 0;  //!< frames in the map
  int failures = 0;
  std::optional<double> start_deviation;        //!< for the next first registration alone [m]
  std::optional<Pose> T_prior;                  //!< of the frame at hand
  Matrix6 prior_information = Matrix6::Zero();  //!< of the prior and the guess
  Matrix6 guess_information = Matrix6::Zero();  //!< of a guess that is not the prior
  double deviation2 = 0;     //!< running mean square of how wrong guesses were [m^2]
  double usual_inliers = 0;  //!< running mean of the inlier share

  RawPoints first;  //!< the first frame, until the second tells its motion
  // Working memory, reused
  RawPoints scan;                          //!< thinned along the rings
  std::vector<Eigen::Vector3f> points;     //!< of `scan`, deskewed
  RawPoints sample;                        //!< what is registered
  std::vector<Eigen::Vector3f> sample_at;  //!< its points as deskewed by prediction
  std::vector<Eigen::Matrix3f> shapes;     //!< of `sample`
  std::vector<std::uint32_t> kept;
};

void LocalMapRefinement::State::setPrior(const Frame& frame,
                                         const Pose& T_guess,
                                         const PosePrior* prior)
{
  Matrix6 of_guess = Matrix6::Zero();
  of_guess.diagonal().head<3>().setConstant(1 / square(options.guess_sigma));
  of_guess.diagonal().tail<3>().setConstant(1 / square(options.guess_sigma_angle));
  if (frame.odometry.converged)
  {
    of_guess += options.odometry_trust * frame.odometry.information;
  }
  guess_information.setZero();
  T_prior.reset();
  prior_information = of_guess;
  if (prior == nullptr)
  {
    return;
  }
  PosePrior joint = *prior;
  if (logSE3(joint.T_odom_vehicle.inverse() * T_guess).norm() > same_pose)
  {
    guess_information = of_guess;
    joint.join(T_guess, of_guess);
  }
  T_prior = joint.T_odom_vehicle;
  prior_information = joint.information;
}

/** Thins the cloud along the rings and takes back its deskewing. */
void LocalMapRefinement::State::takeIn(const Frame& frame)
{
  const Cloud& cloud = frame.cloud;
  const std::size_t count = cloud.size();
  const auto spacing2 = static_cast<float>(options.map_spacing * options.map_spacing);
  Eigen::Vector3f last = Eigen::Vector3f::Constant(1e9F);
  kept.clear();
  kept.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    const Eigen::Vector3f& p = cloud.points[i];
    const float d2 = (p - last).squaredNorm();
    if (d2 >= spacing2 && d2 < 1e30F)
    {
      last = p;
      kept.push_back(static_cast<std::uint32_t>(i));
    }
  }

  const bool skewed = cloud.phase.size() == count;
  const std::vector<float> weights = pointWeights(frame);
  scan.points.resize(kept.size());
  scan.phase.resize(skewed ? kept.size() : 0);
  scan.weight.resize(weights.empty() ? 0 : kept.size());
  points.resize(kept.size());
  const SweepMotion motion(cloud.T_sweep, 0);
  pool.forChunks(kept.size(), 8192,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     const std::uint32_t from = kept[i];
                     const Eigen::Vector3f& p = cloud.points[from];
                     points[i] = p;
                     scan.points[i] = p;
                     if (skewed)
                     {
                       scan.phase[i] = cloud.phase[from];
                       scan.points[i] = motion.toReference(p, -cloud.phase[from]);
                     }
                     if (!weights.empty())
                     {
                       scan.weight[i] = weights[from];
                     }
                   }
                 });
}

/** One point per cube, and evenly fewer where that is still too many. */
void LocalMapRefinement::State::sampleScan()
{
  const VoxelSample voxels = voxelDownsample(points, options.sample_size);
  const std::size_t count = voxels.index.size();
  const auto most = static_cast<std::size_t>(options.max_points);
  const std::size_t taken = std::min(count, most);
  sample.points.resize(taken);
  sample_at.resize(taken);
  sample.phase.resize(scan.phase.empty() ? 0 : taken);
  sample.weight.resize(scan.weight.empty() ? 0 : taken);
  for (std::size_t i = 0; i < taken; ++i)
  {
    const std::uint32_t from = voxels.index[i * count / taken];
    sample.points[i] = scan.points[from];
    sample_at[i] = points[from];
    if (!scan.phase.empty())
    {
      sample.phase[i] = scan.phase[from];
    }
    if (!scan.weight.empty())
    {
      sample.weight[i] = scan.weight[from];
    }
  }
}

/** Covariances of the sampled points' surroundings in their own scan. */
void LocalMapRefinement::State::shapeSample()
{
  shapes.clear();
  if (options.method != RefineMethod::gicp)
  {
    return;
  }
  SurfaceMap own(options.cell_size, options.cell_points, pool);
  own.add(points, scan.weight, Pose::Identity());
  shapes.resize(sample.size());
  pool.forChunks(sample.size(), 512,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     shapes[i] = own.surfaceAt(sample_at[i], VoxelCell()).covariance;
                   }
                 });
}

ScanToMapSettings LocalMapRefinement::State::settings(double start_kernel) const
{
  ScanToMapSettings s;
  s.distributions = options.method == RefineMethod::gicp;
  s.kernel = options.kernel;
  s.start_kernel = std::clamp(start_kernel, options.kernel, options.max_kernel);
  s.max_iterations = options.max_iterations;
  s.correlated_points = options.correlated_points;
  s.level_share = options.level_share;
  s.T_prior = T_prior;
  s.prior_information = prior_information;
  return s;
}

/** Coarse to fine where the guess may be off by more than the map's cells can catch. */
ScanToMapResult LocalMapRefinement::State::registerScan(const Pose& T_before, const Pose& T_guess)
{
  const double expected =
      joined == 1 ? start_deviation.value_or(options.start_deviation) : std::sqrt(deviation2);
  const auto coarseFrom = [&](int factor)
  {
    Pose T = T_guess;
    int iterations = 0;
    for (; factor > 1; factor /= 2)
    {
      const SurfaceMap coarse = map.coarser(factor);
      ScanToMapSettings s = settings(0);
      s.distributions = false;
      s.start_kernel = options.cell_size * factor;
      s.kernel = options.kernel * factor;
      s.prior_information /= static_cast<double>(factor * factor);
      const ScanToMapResult level = registration.align(sample, shapes, coarse, T_before, T, s);
      T = level.T;
      iterations += level.iterations;
    }
    ScanToMapResult fine =
        registration.align(sample, shapes, map, T_before, T, settings(options.max_kernel));
    fine.iterations += iterations;
    return fine;
  };
  int factor = 1;
  while (factor < 8 && expected > options.cell_size * factor)
  {
    factor *= 2;
  }
  if (factor > 1)
  {
    return coarseFrom(factor);
  }
  ScanToMapResult result =
      registration.align(sample, shapes, map, T_before, T_guess, settings(expected));
  if (result.inlier_share < 0.7 * usual_inliers)
  {
    const ScanToMapResult second = coarseFrom(4);
    if (second.inlier_share > result.inlier_share)
    {
      result = second;
    }
  }
  return result;
}

/** The second frame tells how the first one was skewed: both are mended in turn. */
ScanToMapResult LocalMapRefinement::State::registerSecond(const Pose& T_before, const Pose& T_guess)
{
  ScanToMapResult result = registerScan(T_before, T_guess);
  if (first.phase.empty())
  {
    return result;
  }
  std::vector<Eigen::Vector3f> mended;
  for (int round = 0; round < 2; ++round)
  {
    first.deskewed(T_before.inverse() * result.T, pool, mended);
    map.clear();
    map.add(mended, first.weight, T_before);
    const int iterations = result.iterations;
    result =
        registration.align(sample, shapes, map, T_before, result.T, settings(options.max_kernel));
    result.iterations += iterations;
  }
  return result;
}

/** Put the scan, deskewed with the motion found, into the map. */
void LocalMapRefinement::State::join(const Pose& T_before, const Pose& T)
{
  if (joined > 0)
  {
    scan.deskewed(T_before.inverse() * T, pool, points);
    first.clear();
  }
  else
  {
    first = scan;
  }
  map.add(points, scan.weight, T);
  ++joined;
  if ((T.translation() - cropped_at).norm() > crop_share * options.map_radius)
  {
    map.crop(T.translation(), options.map_radius);
    cropped_at = T.translation();
  }
}

LocalMapRefinement::LocalMapRefinement(const RefineOptions& options, ThreadPool& pool)
{
  validate(options, "refine");
  state_ = std::make_unique<State>(options, pool);
}
LocalMapRefinement::~LocalMapRefinement() = default;
LocalMapRefinement::LocalMapRefinement(LocalMapRefinement&&) noexcept = default;

RefineResult LocalMapRefinement::refine(const Frame& frame,
                                        const Pose& T_odom_vehicle_guess,
                                        const PosePrior* prior)
{
  State& s = *state_;
  const Pose T_before = s.T_odom_vehicle;
  const Pose T_guess = orthonormalized(T_odom_vehicle_guess);
  RefineResult result;
  result.T_odom_vehicle = T_guess;
  result.motion = frame.odometry;
  result.motion.T_previous_current = orthonormalized(T_before.inverse() * T_guess);
  s.T_odom_vehicle = T_guess;
  if (s.options.method == RefineMethod::none)
  {
    return result;
  }

  s.setPrior(frame, T_guess, prior);
  result.motion = MotionEstimate();
  result.motion.T_previous_current = orthonormalized(T_before.inverse() * T_guess);
  result.motion.information = s.prior_information;
  result.motion.reason = cloudTrouble(frame);
  result.map_cells = s.map.size();
  if (!result.motion.reason.empty())
  {
    return result;
  }
  s.takeIn(frame);
  if (s.joined == 0)
  {
    s.join(T_guess, T_guess);
    result.motion.converged = true;
    result.map_cells = s.map.size();
    return result;
  }
  s.sampleScan();
  s.shapeSample();
  const ScanToMapResult found =
      s.joined == 1 ? s.registerSecond(T_before, T_guess) : s.registerScan(T_before, T_guess);
  s.start_deviation.reset();
  result.points = s.sample.size();
  result.inlier_share = found.inlier_share;
  result.motion.iterations = found.iterations;
  result.motion.inliers = found.inliers;
  result.motion.rmse = found.rmse;
  result.kernel = s.settings(std::sqrt(s.deviation2)).start_kernel;
  if (found.inliers < fewest_inliers || found.inlier_share < s.options.min_inlier_share)
  {
    result.motion.reason = "the scan does not fit the local map: " + std::to_string(found.inliers) +
                           " of " + std::to_string(result.points) + " points agree";
    if (++s.failures >= patience)
    {
      s.map.clear();
      s.joined = 0;
      s.failures = 0;
      s.join(T_guess, T_guess);
      result.motion.reason += "; the map is begun anew";
    }
    return result;
  }
  s.failures = 0;
  const double off = deviation(T_guess.inverse() * found.T);
  s.deviation2 = s.joined == 1 ? 0 : 0.8 * s.deviation2 + 0.2 * off * off;
  s.usual_inliers =
      s.joined == 1 ? found.inlier_share : 0.9 * s.usual_inliers + 0.1 * found.inlier_share;

  Matrix6 scaled = found.information;
  scaled.bottomRows<3>() /= lever;
  scaled.rightCols<3>() /= lever;
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(scaled, Eigen::EigenvaluesOnly);
  result.degenerate = solver.eigenvalues()[0] < 1 / square(s.options.guess_sigma);
  result.measured_information = found.information + s.guess_information;
  result.prior_weight = found.prior_weight;
  result.motion.information += found.information;
  result.motion.converged = found.settled;
  result.motion.reason = found.settled ? "" : "the registration did not settle";
  result.motion.T_previous_current = orthonormalized(T_before.inverse() * found.T);
  result.T_odom_vehicle = found.T;
  s.T_odom_vehicle = found.T;
  s.join(T_before, found.T);
  result.map_cells = s.map.size();
  return result;
}

void LocalMapRefinement::setStartDeviation(double deviation)
{
  state_->start_deviation = deviation;
}

const Pose& LocalMapRefinement::pose() const
{
  return state_->T_odom_vehicle;
}

std::vector<Eigen::Vector3f> LocalMapRefinement::mapPoints() const
{
  return state_->map.means();
}

void LocalMapRefinement::reset()
{
  state_ = std::make_unique<State>(RefineOptions(state_->options), state_->pool);
}
}  // namespace dyslam
