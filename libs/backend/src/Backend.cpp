// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/PoseInformation.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "GraphData.h"

namespace dyslam
{
namespace
{
/** A frame at its place relative to the keyframe before it. */
struct FrameInKeyframe
{
  double stamp = 0;
  std::size_t keyframe = 0;
  Pose T_keyframe_frame = Pose::Identity();
};

/** Covariance of one odometry step: its own, as far as it makes sense, and a floor. */
Matrix6 stepCovariance(const MotionEstimate& motion, const BackendOptions& options)
{
  const double scale = motion.converged ? 1 : options.unconverged_sigma_scale;
  const double translation = scale * options.odometry_sigma_translation;
  const double rotation = scale * options.odometry_sigma_rotation;
  Vector6 floor;
  floor << Eigen::Vector3d::Constant(translation * translation),
      Eigen::Vector3d::Constant(rotation * rotation);
  Matrix6 covariance = floor.asDiagonal();
  if (motion.converged && motion.information.allFinite())
  {
    const Eigen::LLT<Matrix6> cholesky(motion.information);
    if (cholesky.info() == Eigen::Success)
    {
      const Matrix6 own = cholesky.solve(Matrix6::Identity());
      if (own.allFinite())
      {
        covariance += 0.5 * (own + own.transpose());
      }
    }
  }
  return covariance;
}

mrpt::poses::CPose3DPDFGaussianInf makeEdge(const Pose& mean, const Matrix6& information)
{
  return {toMrptPose(mean), mrpt::math::CMatrixDouble66(informationToYpr(mean, information))};
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
  State(const BackendOptions& given,
        const LoopCloserOptions& loop_options,
        const BackendSolverOptions& solver_options,
        KeyframeStore& store)
      : options(given), keyframes(store), closer(loop_options, store), solver(solver_options)
  {
    validate(options, "backend");
    if (!keyframes.empty())
    {
      throw std::invalid_argument("Backend: the store has keyframes already");
    }
  }

  void accumulateOdometry(const Frame& frame);
  [[nodiscard]] bool wantsKeyframe() const;
  void addKeyframe(const Frame& frame);
  void addLoops(const std::vector<Loop>& decided);
  [[nodiscard]] double whitenedResidual(const Loop& loop) const;
  [[nodiscard]] PoseGraph graph() const;
  void optimise();

  BackendOptions options;
  KeyframeStore& keyframes;
  LoopCloser closer;
  PoseGraphSolver solver;
  PoseGraph edges;  //!< without nodes: these are the keyframes
  std::vector<FrameInKeyframe> frames;
  std::vector<Loop> loops;
  PoseGraphResult last_result;
  Pose T_odom_keyframe = Pose::Identity();  //!< the newest one's, as the odometry has it

  // Since the last keyframe
  Pose T_keyframe_now = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();  //!< of T_keyframe_now, over its tangent
  Pose T_odom_previous = Pose::Identity();
  double path_length = 0;  //!< since the start [m]

  int waiting_loops = 0;      //!< accepted since the last optimisation
  double worst_residual = 0;  //!< of those, whitened
};

void Backend::State::accumulateOdometry(const Frame& frame)
{
  const Pose step = T_odom_previous.inverse() * frame.T_odom_vehicle;
  const Matrix6 carry = adjointSE3(step.inverse());
  covariance = carry * covariance * carry.transpose() + stepCovariance(frame.motion, options);
  T_keyframe_now = orthonormalized(T_keyframe_now * step);
  path_length += step.translation().norm();
}

bool Backend::State::wantsKeyframe() const
{
  return keyframes.empty() || T_keyframe_now.translation().norm() >= options.keyframe_distance ||
         rotationAngle(T_keyframe_now) >= options.keyframe_angle;
}

void Backend::State::addKeyframe(const Frame& frame)
{
  Keyframe keyframe = keyframeOf(frame);
  keyframe.path_length = path_length;
  keyframe.T_map_vehicle = frame.T_odom_vehicle;
  if (!keyframes.empty())
  {
    keyframe.T_map_vehicle = keyframes.back().T_map_vehicle * T_keyframe_now;
    Matrix6 information = covariance.inverse();
    information = 0.5 * (information + information.transpose()).eval();
    const std::size_t id = keyframes.size();
    edges.insertEdge(id - 1, id, makeEdge(T_keyframe_now, information));
  }
  keyframes.add(std::move(keyframe));
  T_odom_keyframe = frame.T_odom_vehicle;
  T_keyframe_now = Pose::Identity();
  covariance.setZero();
  if (options.mode == BackendMode::ego)
  {
    closer.add(staticPoints(frame));
    addLoops(closer.search());
    if (waiting_loops >= options.loops_to_optimise ||
        (waiting_loops > 0 && worst_residual > options.residual_to_optimise))
    {
      optimise();
    }
  }
}

double Backend::State::whitenedResidual(const Loop& loop) const
{
  const Pose estimate =
      keyframes[loop.from].T_map_vehicle.inverse() * keyframes[loop.to].T_map_vehicle;
  const Vector6 error = logSE3(loop.T_from_to.inverse() * estimate);
  return std::sqrt(error.dot(loop.information * error));
}

void Backend::State::addLoops(const std::vector<Loop>& decided)
{
  for (const Loop& loop : decided)
  {
    loops.push_back(loop);
    if (loop.verdict == LoopVerdict::accepted)
    {
      edges.insertEdge(loop.from, loop.to, makeEdge(loop.T_from_to, loop.information));
      worst_residual = std::max(worst_residual, whitenedResidual(loop));
      ++waiting_loops;
    }
  }
}

PoseGraph Backend::State::graph() const
{
  PoseGraph whole = edges;
  for (std::size_t i = 0; i < keyframes.size(); ++i)
  {
    static_cast<mrpt::poses::CPose3D&>(whole.nodes[i]) = toMrptPose(keyframes[i].T_map_vehicle);
  }
  return whole;
}

void Backend::State::optimise()
{
  PoseGraph whole = graph();
  last_result = solver.solve(whole);
  std::vector<Pose> corrected;
  for (const auto& [id, pose] : whole.nodes)
  {
    corrected.push_back(fromMrptPose(pose));
  }
  keyframes.correct(corrected);
  waiting_loops = 0;
  worst_residual = 0;
}

void BackendOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("mode", mode, {{"odometry", BackendMode::odometry}, {"ego", BackendMode::ego}},
                 "what the graph holds: odometry alone, or odometry and loops");
  visitor.real("keyframe_distance", keyframe_distance, 0, 1000,
               "a new keyframe after this distance [m]");
  visitor.degrees("keyframe_angle_deg", keyframe_angle, 0, 180, "or after this turn");
  visitor.real("odometry_sigma_translation", odometry_sigma_translation, 1e-6, 100,
               "added to each step's own uncertainty [m]");
  visitor.real("odometry_sigma_rotation", odometry_sigma_rotation, 1e-7, 3,
               "the same for rotation [rad]");
  visitor.real("unconverged_sigma_scale", unconverged_sigma_scale, 1, 1e4,
               "factor on both where the odometry did not converge");
  visitor.real("residual_to_optimise", residual_to_optimise, 0, 1e6,
               "optimise when a new loop is off by this many standard deviations");
  visitor.integer("loops_to_optimise", loops_to_optimise, 1, 100000,
                  "or this many loops have come");
}

BackendSolverOptions::BackendSolverOptions()
{
  residual = EdgeResidual::log;
  loop_loss = RobustLoss::dcs;
  start = GraphStart::file;
  max_iterations = 50;
  tolerance = 1e-6;
}

Backend::Backend(const BackendOptions& options,
                 const LoopCloserOptions& loops,
                 const BackendSolverOptions& solver,
                 KeyframeStore& keyframes)
    : state_(std::make_unique<State>(options, loops, solver, keyframes))
{
}
Backend::~Backend() = default;
Backend::Backend(Backend&&) noexcept = default;
Backend& Backend::operator=(Backend&&) noexcept = default;

void Backend::addFrame(Frame& frame)
{
  State& s = *state_;
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
  s.frames.push_back({frame.scan.stamp, s.keyframes.size() - 1, s.T_keyframe_now});
  frame.T_map_odom = s.keyframes.back().T_map_vehicle * s.T_odom_keyframe.inverse();
}

void Backend::finish()
{
  State& s = *state_;
  s.addLoops(s.closer.finish());
  if (s.waiting_loops > 0)
  {
    s.optimise();
  }
}

PoseGraph Backend::graph() const
{
  return state_->graph();
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

const PoseGraphResult& Backend::lastOptimisation() const
{
  return state_->last_result;
}
}  // namespace dyslam
