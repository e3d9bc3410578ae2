// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/core/MotionAccumulator.h>
#include <dyslam/core/PathLength.h>
#include <dyslam/core/StateArchive.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "FrameInKeyframe.h"
#include "GnssAnchor.h"
#include "GravityAnchor.h"
#include "LoopCorrection.h"
#include "ObjectGraph.h"
#include "PoseGraphView.h"
#include "UnseenPath.h"

namespace dyslam
{
namespace
{
/** Sigma of the rotation over an unmeasured stretch of the path [rad]. */
constexpr double unseen_rotation = 0.5;

/** Covariance of one odometry step: that of the odometry (a step that was not registered has the
 * prior's, large after a gap), and the option's in addition where it did not converge. */
Matrix6 stepCovariance(const MotionEstimate& motion, const BackendOptions& options)
{
  Vector6 sigmas;
  sigmas << Eigen::Vector3d::Constant(options.unconverged_sigma),
      Eigen::Vector3d::Constant(options.unconverged_sigma_rotation);
  const Matrix6 unconverged = sigmas.array().square().matrix().asDiagonal();
  if (motion.information.allFinite())
  {
    const Eigen::LLT<Matrix6> cholesky(motion.information);
    if (cholesky.info() == Eigen::Success)
    {
      const Matrix6 own = cholesky.solve(Matrix6::Identity());
      if (own.allFinite())
      {
        const Matrix6 symmetric = 0.5 * (own + own.transpose());
        return motion.converged() ? symmetric : Matrix6(symmetric + unconverged);
      }
    }
  }
  return unconverged;
}

std::vector<Eigen::Vector3f> staticPoints(const Frame& frame)
{
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (!frame.isMoving(i))
    {
      points.push_back(frame.cloud.points[i]);
    }
  }
  return points;
}
}  // namespace

struct Backend::State
{
  State(const BackendConfig& config, KeyframeStore& store)
      : options(config.backend),
        solver(config.solver),
        window_keyframes(static_cast<std::size_t>(config.objects.window_keyframes)),
        keyframes(store),
        closer(config.loops, store),
        correction(config.backend, config.solver, graph),
        objects(config.objects, config.backend.mode == BackendMode::full, graph),
        gnss(config.gnss),
        gravity_anchor(config.gravity)
  {
    validate(options, "backend");
    validate(solver, "solver");
    validate(gnss.options(), "gnss");
    validate(gravity_anchor.options(), "gravity");
    if (!keyframes.empty())
    {
      throw std::invalid_argument("Backend: the store has keyframes already");
    }
  }

  [[nodiscard]] bool hasObjects() const
  {
    return options.mode == BackendMode::segmot || options.mode == BackendMode::full;
  }
  void accumulateOdometry(const Frame& frame);
  [[nodiscard]] bool wantsKeyframe() const;
  void addKeyframe(const Frame& frame);
  /** \return number of loops added to the graph. */
  std::size_t insertLoops(const std::vector<Loop>& decided);
  [[nodiscard]] std::set<Key> objectsOf(const Frame& frame) const;
  bool optimiseWindow(const Frame& frame);
  void optimiseForLoops(const Frame& frame);
  void optimiseAll();
  void correctKeyframes(std::size_t first);
  [[nodiscard]] std::optional<VehicleInKeyframe> vehicleAt(double stamp) const;
  void tieToVertical();
  void levelMap(const Pose& T_level_map);
  void tieToEarth();

  BackendOptions options;
  FactorGraphOptions solver;
  std::size_t window_keyframes;
  KeyframeStore& keyframes;
  LoopCloser closer;
  FactorGraph graph;
  LoopCorrection correction;
  ObjectGraph objects;
  GnssAnchor gnss;
  std::optional<Georeference> georeference;
  GravityAnchor gravity_anchor;
  std::optional<Gravity> gravity;
  std::vector<FrameInKeyframe> frames;
  std::vector<Loop> loops;
  std::vector<std::string> problems;        //!< factors that the graph rejected
  Pose T_odom_keyframe = Pose::Identity();  //!< odometry pose of the newest keyframe

  MotionAccumulator since_keyframe;
  Pose T_odom_previous = Pose::Identity();
  PathLength path;         //!< distance travelled by the odometry
  UnseenPath unseen_path;  //!< unmeasured distance
  double drift = 0;        //!< accumulated variance of the steps' translation, per axis [m^2]
  double drift_angle = 0;  //!< accumulated variance of the steps' rotation, per axis [rad^2]
};

void Backend::State::accumulateOdometry(const Frame& frame)
{
  const Pose step = T_odom_previous.inverse() * frame.T_odom_vehicle;
  const double unseen = unseen_path.add(frame, step.translation().norm());
  Matrix6 own = stepCovariance(frame.motion, options);
  if (unseen > 0)
  {
    own.diagonal().head<3>().array() += unseen * unseen;
    own.diagonal().tail<3>().array() += unseen_rotation * unseen_rotation;
  }
  since_keyframe.add(step, own, frame.motion.pose_noise);
  const Vector6 lasting = (own - 2 * frame.motion.pose_noise).diagonal().cwiseMax(0);
  drift += lasting.head<3>().mean();
  drift_angle += lasting.tail<3>().mean();
}

bool Backend::State::wantsKeyframe() const
{
  const Pose& moved = since_keyframe.motion();
  return keyframes.empty() || moved.translation().norm() >= options.keyframe_distance ||
         rotationAngle(moved) >= options.keyframe_angle;
}

void Backend::State::addKeyframe(const Frame& frame)
{
  const std::size_t id = keyframes.size();
  Keyframe keyframe = keyframeOf(frame);
  keyframe.path_length = path.length();
  keyframe.unseen_path = unseen_path.length();
  keyframe.T_map_vehicle =
      id == 0 ? frame.T_odom_vehicle : keyframes.back().T_map_vehicle * since_keyframe.motion();
  graph.addPose(Key::ego(id), keyframe.T_map_vehicle);
  if (id == 0)
  {
    graph.setFixed(Key::ego(0), true);
  }
  else
  {
    constexpr double floor = 1e-12;  // keeps the covariance positive definite [m^2, rad^2]
    Matrix6 information = (since_keyframe.covariance() + floor * Matrix6::Identity()).inverse();
    information = 0.5 * (information + information.transpose()).eval();
    graph.add(std::make_unique<OdometryFactor>(id - 1, id, since_keyframe.motion(), information));
  }
  keyframes.add(keyframe);
  T_odom_keyframe = frame.T_odom_vehicle;
  since_keyframe.restart();
}

std::size_t Backend::State::insertLoops(const std::vector<Loop>& decided)
{
  std::size_t added = 0;
  for (const Loop& loop : decided)
  {
    loops.push_back(loop);
    if (loop.verdict != LoopVerdict::accepted)
    {
      continue;
    }
    try
    {
      correction.add(graph.add(
          std::make_unique<LoopFactor>(loop.from, loop.to, loop.T_from_to, loop.information)));
      ++added;
    }
    catch (const std::invalid_argument& e)
    {
      problems.push_back(std::string("a loop was left out: ") + e.what());
    }
  }
  return added;
}

/** Copies the poses of keyframes from number `first` on from the graph. */
void Backend::State::correctKeyframes(std::size_t first)
{
  std::vector<Pose> corrected;
  for (std::size_t i = first; i < keyframes.size(); ++i)
  {
    corrected.push_back(graph.pose(Key::ego(i)));
  }
  keyframes.correct(corrected, first);
}

/** Variables of objects that are optimised with the newest keyframes. */
std::set<Key> Backend::State::objectsOf(const Frame& frame) const
{
  std::set<Key> objects_now;
  if (hasObjects())
  {
    objects.appendWindow(frame.time(), objects_now);
  }
  return objects_now;
}

bool Backend::State::optimiseWindow(const Frame& frame)
{
  std::set<Key> free = objectsOf(frame);
  if (free.empty())
  {
    return false;
  }
  const std::size_t first =
      std::max<std::size_t>(1, keyframes.size() - std::min(keyframes.size(), window_keyframes));
  for (std::size_t i = first; i < keyframes.size(); ++i)
  {
    free.insert(Key::ego(i));
  }
  constexpr int steps = 3;  // enough from a good initial value; the next window continues from here
  FactorGraphOptions quick = solver;
  quick.max_iterations = std::min(steps, solver.max_iterations);
  (void)graph.optimise(quick, free);
  correctKeyframes(first);
  return true;
}

void Backend::State::optimiseForLoops(const Frame& frame)
{
  correctKeyframes(correction.correct(keyframes.size(), objectsOf(frame)));
}

void Backend::State::optimiseAll()
{
  correction.correctAll(keyframes.size());
  correctKeyframes(0);
}

/** Interpolates between the scans before and after the stamp. */
std::optional<VehicleInKeyframe> Backend::State::vehicleAt(double stamp) const
{
  constexpr double longest_gap = 1;  // longest time between the two scans [s]
  const auto after = std::lower_bound(frames.begin(), frames.end(), stamp,
                                      [](const FrameInKeyframe& frame, double time)
                                      { return frame.stamp < time; });
  if (after != frames.end() && after->stamp == stamp)
  {
    return VehicleInKeyframe{after->keyframe, after->T_keyframe_frame};
  }
  if (after == frames.begin() || after == frames.end() ||
      after->stamp - std::prev(after)->stamp > longest_gap)
  {
    return std::nullopt;
  }
  const FrameInKeyframe& before = *std::prev(after);
  const Pose T_before_after = before.T_keyframe_frame.inverse() *
                              graph.pose(Key::ego(before.keyframe)).inverse() *
                              graph.pose(Key::ego(after->keyframe)) * after->T_keyframe_frame;
  const double part = (stamp - before.stamp) / (after->stamp - before.stamp);
  return VehicleInKeyframe{before.keyframe,
                           before.T_keyframe_frame * expSE3(part * logSE3(T_before_after))};
}

void Backend::State::tieToVertical()
{
  const FactorGraph::Solution before = graph.solution();
  const OptimisationResult result_before = correction.last();
  if (!gravity_anchor.addTo(graph, frames))
  {
    return;
  }
  const bool fuse =
      gravity_anchor.options().use == GravityUse::fuse && options.mode != BackendMode::odometry;
  if (fuse)
  {
    optimiseAll();
  }
  const bool fits = gravity_anchor.fits(graph);
  if (fits)
  {
    gravity = gravity_anchor.gravity(graph);
    gravity->fused = fuse;
  }
  else
  {
    gravity_anchor.warn(
        "the accelerations of the IMU are not used: they do not fit the trajectory; is the pose of "
        "the IMU on the vehicle right, and its clock that of the lidar?");
  }
  if (fuse && !fits)
  {
    graph.restore(before);
    correction.restoreLast(result_before);
    correctKeyframes(0);
  }
  const Pose T_level_map = graph.pose(Key::vertical());
  if (!fuse || !fits)
  {
    GravityAnchor::removeFrom(graph);
  }
  if (fits && gravity_anchor.options().level_map)
  {
    levelMap(T_level_map);
  }
}

/** Rotates all poses of the graph. */
void Backend::State::levelMap(const Pose& T_level_map)
{
  std::vector<std::pair<Key, Pose>> levelled;
  for (const auto& [key, variable] : graph.variables())
  {
    if (key.isPose())
    {
      const Pose T = unpackPose(variable.block.data());
      levelled.emplace_back(key,
                            key == Key::vertical() ? T * T_level_map.inverse() : T_level_map * T);
    }
  }
  for (const auto& [key, pose] : levelled)
  {
    graph.setPose(key, pose);
  }
  gravity->up_map = Eigen::Vector3d::UnitZ();
  gravity->levelled = true;
  correctKeyframes(0);
}

void Backend::State::tieToEarth()
{
  const Key earth = Key::georeference();
  if (!gnss.addTo(graph, [this](double stamp) { return vehicleAt(stamp); }))
  {
    return;
  }
  (void)graph.optimise(solver, {earth});
  constexpr double usual_drift = 0.05;  // fraction of the trajectory's extent
  const bool fuse = gnss.options().use == GnssUse::fuse && options.mode != BackendMode::odometry;
  bool fits = fuse || gnss.fits(graph, usual_drift);
  if (fuse)
  {
    const FactorGraph::Solution before = graph.solution();
    const OptimisationResult result_before = correction.last();
    optimiseAll();
    fits = gnss.fits(graph, 0);
    if (!fits)
    {
      graph.restore(before);
      correction.restoreLast(result_before);
      correctKeyframes(0);
    }
  }
  if (!fits)
  {
    graph.remove(earth);
    gnss.warn(
        "the positions of the satellite receiver are not used: most of them do not fit the "
        "trajectory; is its clock that of the lidar, and the place of its antenna right?");
    return;
  }
  georeference = gnss.georeference(graph);
  georeference->fused = fuse;
  if (!fuse)
  {
    graph.remove(earth);
  }
}

void BackendOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice(
      "mode", mode,
      {{"odometry", BackendMode::odometry},
       {"ego", BackendMode::ego},
       {"segmot", BackendMode::segmot},
       {"full", BackendMode::full}},
      "factors of the graph: odometry; ego: also loops; segmot: also objects, all as moving; "
      "full: also objects, static ones as landmarks");
  visitor.real("keyframe_distance", keyframe_distance, 0, 1000,
               "translation since the last keyframe after which a new one is added [m]");
  visitor.degrees("keyframe_angle_deg", keyframe_angle, 0, 180,
                  "rotation since the last keyframe after which a new one is added [deg]");
  visitor.real("unconverged_sigma", unconverged_sigma, 1e-6, 100,
               "sigma of the translation of a step for which the odometry did not converge [m]");
  visitor.degrees("unconverged_sigma_rotation_deg", unconverged_sigma_rotation, 1e-5, 180,
                  "sigma of the rotation of a step for which the odometry did not converge [deg]");
  visitor.renamed("unconverged_sigma_translation", "unconverged_sigma");
  visitor.real("residual_to_optimise", residual_to_optimise, 0, 1e6,
               "whitened residual of a new loop above which the graph is optimised [sigmas]");
  visitor.integer("loops_to_optimise", loops_to_optimise, 1, 100000,
                  "number of new loops after which the graph is optimised");
  visitor.integer(
      "correction_keyframes", correction_keyframes, 0, 1000000,
      "newest keyframes optimised for a loop that is consistent with odometry and earlier loops; "
      "0: all");
  visitor.real("correction_growth", correction_growth, 0, 10,
               "growth of the number of keyframes after which a loop optimises all of them again, "
               "as a fraction");
}

Backend::Backend(const BackendConfig& config, KeyframeStore& keyframes)
    : state_(std::make_unique<State>(config, keyframes))
{
}
Backend::~Backend() = default;
Backend::Backend(Backend&&) noexcept = default;
Backend& Backend::operator=(Backend&&) noexcept = default;

bool Backend::addOdometry(Frame& frame)
{
  State& s = *state_;
  s.path.add(frame.T_odom_vehicle.translation());
  s.gravity_anchor.add(frame, s.T_odom_previous.inverse() * frame.T_odom_vehicle);
  if (!s.frames.empty())
  {
    s.accumulateOdometry(frame);
  }
  s.T_odom_previous = frame.T_odom_vehicle;
  frame.is_keyframe = s.wantsKeyframe();
  if (frame.is_keyframe)
  {
    s.addKeyframe(frame);
  }
  s.gnss.add(frame.gnss);
  s.frames.push_back({frame.scan.stamp, s.keyframes.size() - 1, s.since_keyframe.motion()});
  if (s.hasObjects())
  {
    s.objects.add(frame, {s.keyframes.size() - 1, s.since_keyframe.motion(),
                          s.since_keyframe.covariance(), s.drift, s.drift_angle});
  }
  frame.T_map_odom = s.keyframes.back().T_map_vehicle * s.T_odom_keyframe.inverse();
  return frame.is_keyframe;
}

std::size_t Backend::addLoops(const Frame& frame)
{
  State& s = *state_;
  if (!frame.is_keyframe || s.options.mode == BackendMode::odometry)
  {
    return 0;
  }
  // Where a scan was not registered, its neighbours are not where the keyframe's pose says: within
  // a submap its points would confirm whatever motion was predicted.
  s.closer.add(frame.motion.registered() ? staticPoints(frame) : std::vector<Eigen::Vector3f>());
  return s.insertLoops(s.closer.search());
}

bool Backend::optimise(Frame& frame)
{
  State& s = *state_;
  bool changed = false;
  if (s.correction.isDue())
  {
    s.optimiseForLoops(frame);
    changed = true;
  }
  else if (frame.is_keyframe && s.hasObjects() && s.window_keyframes > 0)
  {
    changed = s.optimiseWindow(frame);
  }
  frame.T_map_odom = s.keyframes.back().T_map_vehicle * s.T_odom_keyframe.inverse();
  return changed;
}

void Backend::addFrame(Frame& frame)
{
  addOdometry(frame);
  addLoops(frame);
  optimise(frame);
}

void Backend::finish()
{
  State& s = *state_;
  (void)s.insertLoops(s.closer.finish());
  if (s.hasObjects())
  {
    s.objects.finish();
  }
  if (s.correction.isAnyOpen() || s.hasObjects())
  {
    s.optimiseAll();
  }
  if (s.hasObjects() && s.objects.releaseContradicted(s.solver) > 0)
  {
    s.optimiseAll();
  }
  s.tieToVertical();
  s.tieToEarth();
}

const FactorGraph& Backend::factorGraph() const
{
  return state_->graph;
}

PoseGraph Backend::graph() const
{
  return poseGraphView(state_->graph);
}

const KeyframeStore& Backend::keyframes() const
{
  return state_->keyframes;
}

Trajectory Backend::optimizedTrajectory() const
{
  Trajectory trajectory;
  for (const FrameInKeyframe& frame : state_->frames)
  {
    trajectory.push_back(frame.stamp,
                         state_->keyframes[frame.keyframe].T_map_vehicle * frame.T_keyframe_frame);
  }
  return trajectory;
}

const std::vector<Loop>& Backend::loops() const
{
  return state_->loops;
}

std::vector<SmoothedObject> Backend::smoothedObjects() const
{
  return state_->objects.smoothed();
}

const std::optional<Georeference>& Backend::georeference() const
{
  return state_->georeference;
}

const std::optional<Gravity>& Backend::gravity() const
{
  return state_->gravity;
}

const OptimisationResult& Backend::lastOptimisation() const
{
  return state_->correction.last();
}

std::vector<std::string> Backend::warnings() const
{
  std::vector<std::string> result = state_->problems;
  for (const auto& more : {state_->correction.last().warnings, state_->objects.warnings(),
                           state_->gravity_anchor.warnings(), state_->gnss.warnings()})
  {
    result.insert(result.end(), more.begin(), more.end());
  }
  return result;
}

void Backend::exchangeState(StateArchive& archive)
{
  State& s = *state_;
  archive(s.closer, s.graph, s.objects, s.gnss, s.gravity_anchor, s.frames, s.loops, s.correction,
          s.problems, s.T_odom_keyframe, s.since_keyframe, s.T_odom_previous, s.path, s.unseen_path,
          s.drift, s.drift_angle);
}
}  // namespace dyslam
