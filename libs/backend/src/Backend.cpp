// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/StateArchive.h>
#include <mrpt/graphs/CNetworkOfPoses.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "BackendState.h"
#include "graph/CovarianceInverse.h"
#include "graph/PoseGraphView.h"

namespace dyslam
{
namespace
{
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

BackendConfig BackendConfig::load(ConfigLoader& config)
{
  return {config.get<BackendOptions>("backend"),     config.get<LoopCloserOptions>("loop"),
          config.get<ObjectGraphOptions>("objects"), config.get<FactorGraphOptions>("solver"),
          config.get<GnssOptions>("gnss"),           config.get<GravityOptions>("gravity"),
          config.get<PriorMapOptions>("prior_map")};
}

void Backend::State::addKeyframe(const Frame& frame)
{
  const std::size_t id = keyframes.size();
  Keyframe keyframe = keyframeOf(frame);
  const MotionAccumulator& since_keyframe = odometry.sinceKeyframe();
  keyframe.path_length = odometry.pathLength();
  keyframe.unseen_path = odometry.unseenLength();
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
    const Matrix6 covariance = since_keyframe.covariance() + floor * Matrix6::Identity();
    graph.add(std::make_unique<OdometryFactor>(id - 1, id, since_keyframe.motion(),
                                               informationFromCovariance(covariance)));
  }
  keyframes.add(keyframe);
  odometry.beginAtKeyframe();
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

void Backend::State::localise()
{
  const MapFixes found = localiser.add();
  if (found.T_prior_map)
  {
    moveMap(*found.T_prior_map);
    graph.addPose(Key::priorMap(), Pose::Identity());
    graph.setFixed(Key::priorMap(), true);
    graph.setFixed(Key::ego(0), false);
  }
  if (found.T_prior_map || found.is_found_again)
  {
    for (const FactorGraph::FactorId id : stretches.begin(found.fixes))
    {
      correction.remove(id);
    }
    is_localised_now = true;
  }
  for (const FactorGraph::FactorId id : stretches.add(found.fixes))
  {
    correction.add(id);
  }
}

void Backend::State::moveMap(const Pose& T_new_old)
{
  std::vector<std::pair<Key, Pose>> moved;
  for (const auto& [key, variable] : graph.variables())
  {
    const bool is_of_map = key == Key::vertical() || key == Key::georeference();
    if (key.isPose())
    {
      const Pose T = unpackPose(variable.block.data());
      moved.emplace_back(key, is_of_map ? T * T_new_old.inverse() : T_new_old * T);
    }
  }
  for (const auto& [key, pose] : moved)
  {
    graph.setPose(key, pose);
  }
  correctKeyframes(0);
}

void Backend::State::correctKeyframes(std::size_t first)
{
  std::vector<Pose> corrected;
  for (std::size_t i = first; i < keyframes.size(); ++i)
  {
    corrected.push_back(graph.pose(Key::ego(i)));
  }
  keyframes.correct(corrected, first);
}

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

Backend::Backend(const BackendConfig& config,
                 KeyframeStore& keyframes,
                 const std::vector<Eigen::Vector3f>& prior_map)
    : state_(std::make_unique<State>(config, keyframes, prior_map))
{
}
Backend::~Backend() = default;
Backend::Backend(Backend&&) noexcept = default;
Backend& Backend::operator=(Backend&&) noexcept = default;

bool Backend::addOdometry(Frame& frame)
{
  State& s = *state_;
  const Pose step = s.odometry.add(frame, s.frames.empty());
  s.addAccelerations(frame, step);
  frame.is_keyframe = s.keyframes.empty() || s.odometry.isKeyframeDue();
  if (frame.is_keyframe)
  {
    s.addKeyframe(frame);
  }
  s.addPositions(frame);
  const MotionAccumulator& since_keyframe = s.odometry.sinceKeyframe();
  s.frames.push_back(
      {frame.scan.stamp, frame.time(), s.keyframes.size() - 1, since_keyframe.motion()});
  if (s.hasObjects())
  {
    s.objects.add(frame,
                  {s.keyframes.size() - 1, since_keyframe.motion(), since_keyframe.covariance(),
                   s.odometry.drift(), s.odometry.driftAngle()});
  }
  frame.T_map_odom = s.mapFromOdometry();
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
  const std::size_t added = s.insertLoops(s.closer.search());
  s.localise();
  return added;
}

bool Backend::optimise(Frame& frame)
{
  State& s = *state_;
  bool changed = false;
  if (std::exchange(s.is_localised_now, false))
  {
    s.optimiseAll();
    changed = true;
  }
  else if (s.correction.isDue())
  {
    s.optimiseForLoops(frame);
    changed = true;
  }
  else if (frame.is_keyframe && s.hasObjects() && s.window_keyframes > 0)
  {
    changed = s.optimiseWindow(frame);
  }
  frame.T_map_odom = s.mapFromOdometry();
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

Trajectory Backend::optimisedTrajectory() const
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

std::optional<PriorMapFit> Backend::priorMapFit() const
{
  const State& s = *state_;
  if (!s.localiser.hasMap())
  {
    return std::nullopt;
  }
  PriorMapFit fit = s.localiser.fit();
  fit.registered = s.stretches.localisations();
  fit.rmse = s.stretches.rmse();
  return fit;
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
          s.problems, s.odometry, s.localiser, s.stretches);
}
}  // namespace dyslam
