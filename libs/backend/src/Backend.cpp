// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/PoseInformation.h>

#include <Eigen/Dense>
#include <cmath>
#include <utility>

#include "GraphData.h"

namespace dyslam
{
namespace
{
/** Where a frame stands beside its keyframe. */
struct RidingFrame
{
  double stamp = 0;
  std::size_t keyframe = 0;
  Pose T_keyframe_frame = Pose::Identity();
};

struct Keyframe
{
  std::size_t frame = 0;
  double stamp = 0;
  double path_length = 0;
  Pose T_odom_vehicle = Pose::Identity();
  Pose T_map_vehicle = Pose::Identity();
};

/** Covariance of one odometry step: its own, as far as it makes sense, and a floor. */
Matrix6 stepCovariance(const MotionEstimate& motion, const BackendOptions& options)
{
  const double factor = motion.converged ? 1 : options.unconverged_factor;
  const double translation = factor * options.odometry_sigma_translation;
  const double rotation = factor * options.odometry_sigma_rotation;
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
        const BackendSolverOptions& solver_options)
      : options(given), closer(loop_options), solver(solver_options)
  {
    validate(options, "backend");
  }

  void moveOn(const Frame& frame);
  [[nodiscard]] bool wantsKeyframe() const;
  void addKeyframe(const Frame& frame);
  void take(const std::vector<Loop>& decided);
  [[nodiscard]] double misfit(const Loop& loop) const;
  void optimise();
  [[nodiscard]] Pose T_map_odom() const
  {
    return keyframes.back().T_map_vehicle * keyframes.back().T_odom_vehicle.inverse();
  }

  BackendOptions options;
  LoopCloser closer;
  PoseGraphSolver solver;
  mrpt::graphs::CNetworkOfPoses3DInf graph;
  std::vector<Keyframe> keyframes;
  std::vector<Pose> T_map_keyframe;  //!< of keyframes, as the loop closer wants them
  std::vector<RidingFrame> frames;
  std::vector<Loop> loops;
  PoseGraphResult last_result;
  std::size_t revision = 0;

  // Since the last keyframe
  Pose T_keyframe_now = Pose::Identity();
  Matrix6 covariance = Matrix6::Zero();  //!< of T_keyframe_now, over its tangent
  Pose T_odom_previous = Pose::Identity();
  double path_length = 0;  //!< since the start [m]

  int waiting_loops = 0;    //!< accepted since the last optimisation
  double worst_misfit = 0;  //!< of those, whitened
};

void Backend::State::moveOn(const Frame& frame)
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
  Keyframe keyframe;
  keyframe.frame = frame.index;
  keyframe.stamp = frame.scan.stamp;
  keyframe.path_length = path_length;
  keyframe.T_odom_vehicle = frame.T_odom_vehicle;
  keyframe.T_map_vehicle =
      keyframes.empty() ? frame.T_odom_vehicle : keyframes.back().T_map_vehicle * T_keyframe_now;
  const std::size_t id = keyframes.size();
  static_cast<mrpt::poses::CPose3D&>(graph.nodes[id]) = toMrptPose(keyframe.T_map_vehicle);
  if (id > 0)
  {
    Matrix6 information = covariance.inverse();
    information = 0.5 * (information + information.transpose()).eval();
    graph.insertEdge(id - 1, id, makeEdge(T_keyframe_now, information));
  }
  keyframes.push_back(keyframe);
  T_map_keyframe.push_back(keyframe.T_map_vehicle);
  T_keyframe_now = Pose::Identity();
  covariance.setZero();
  if (options.mode == BackendMode::ego)
  {
    closer.add({id, path_length, staticPoints(frame)});
    take(closer.search(T_map_keyframe));
    if (waiting_loops >= options.loops_to_optimise ||
        (waiting_loops > 0 && worst_misfit > options.misfit_to_optimise))
    {
      optimise();
    }
  }
}

double Backend::State::misfit(const Loop& loop) const
{
  const Pose estimate = T_map_keyframe[loop.from].inverse() * T_map_keyframe[loop.to];
  const Vector6 error = logSE3(loop.T_from_to.inverse() * estimate);
  return std::sqrt(error.dot(loop.information * error));
}

void Backend::State::take(const std::vector<Loop>& decided)
{
  for (const Loop& loop : decided)
  {
    loops.push_back(loop);
    if (loop.verdict == LoopVerdict::accepted)
    {
      graph.insertEdge(loop.from, loop.to, makeEdge(loop.T_from_to, loop.information));
      worst_misfit = std::max(worst_misfit, misfit(loop));
      ++waiting_loops;
    }
  }
}

void Backend::State::optimise()
{
  last_result = solver.solve(graph);
  for (std::size_t i = 0; i < keyframes.size(); ++i)
  {
    keyframes[i].T_map_vehicle = fromMrptPose(graph.nodes[i]);
    T_map_keyframe[i] = keyframes[i].T_map_vehicle;
  }
  waiting_loops = 0;
  worst_misfit = 0;
  ++revision;
}

void BackendOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("mode", mode, {{"odometry", BackendMode::odometry}, {"ego", BackendMode::ego}},
                 "what the graph holds: odometry alone, or odometry and loops");
  visitor.real("keyframe_distance", keyframe_distance, 0, 1000,
               "a new keyframe after this way [m]");
  visitor.degrees("keyframe_angle_deg", keyframe_angle, 0, 180, "or after this turn");
  visitor.real("odometry_sigma_translation", odometry_sigma_translation, 1e-6, 100,
               "added to each step's own uncertainty [m]");
  visitor.real("odometry_sigma_rotation", odometry_sigma_rotation, 1e-7, 3,
               "the same for rotation [rad]");
  visitor.real("unconverged_factor", unconverged_factor, 1, 1e4,
               "on both where the odometry did not converge");
  visitor.real("misfit_to_optimise", misfit_to_optimise, 0, 1e6,
               "optimise when a new loop is off by this many standard deviations");
  visitor.integer("loops_to_optimise", loops_to_optimise, 1, 100000,
                  "or this many loops have come");
}

BackendSolverOptions::BackendSolverOptions()
{
  residual = EdgeResidual::log;
  loop_kernel = RobustKernel::dcs;
  start = GraphStart::file;
  max_iterations = 50;
  tolerance = 1e-6;
}

Backend::Backend(const BackendOptions& options,
                 const LoopCloserOptions& loops,
                 const BackendSolverOptions& solver)
    : state_(std::make_unique<State>(options, loops, solver))
{
}
Backend::~Backend() = default;
Backend::Backend(Backend&&) noexcept = default;
Backend& Backend::operator=(Backend&&) noexcept = default;

void Backend::addFrame(Frame& frame)
{
  State& s = *state_;
  if (s.frames.empty())
  {
    s.T_odom_previous = frame.T_odom_vehicle;
  }
  else
  {
    s.moveOn(frame);
  }
  s.T_odom_previous = frame.T_odom_vehicle;
  frame.is_keyframe = s.wantsKeyframe();
  if (frame.is_keyframe)
  {
    s.addKeyframe(frame);
  }
  s.frames.push_back({frame.scan.stamp, s.keyframes.size() - 1, s.T_keyframe_now});
  frame.T_map_odom = s.T_map_odom();
}

void Backend::finish()
{
  State& s = *state_;
  s.take(s.closer.finish());
  if (s.waiting_loops > 0)
  {
    s.optimise();
  }
}

const PoseGraph& Backend::graph() const
{
  return state_->graph;
}

std::vector<KeyframePose> Backend::keyframes() const
{
  std::vector<KeyframePose> result;
  for (const Keyframe& keyframe : state_->keyframes)
  {
    result.push_back({result.size(), keyframe.frame, keyframe.stamp, keyframe.T_map_vehicle});
  }
  return result;
}

std::size_t Backend::revision() const
{
  return state_->revision;
}

Trajectory Backend::optimizedTrajectory() const
{
  Trajectory trajectory;
  for (const RidingFrame& frame : state_->frames)
  {
    trajectory.push_back(frame.stamp,
                         state_->T_map_keyframe[frame.keyframe] * frame.T_keyframe_frame);
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
