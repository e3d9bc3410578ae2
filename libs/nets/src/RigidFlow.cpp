// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/nets/RigidFlow.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr double annealing_factor = 0.6;
constexpr int final_iterations = 3;

struct WeightedSums
{
  double weight = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
};

/** Weighted least-squares motion in closed form. \return the total weight, 0 if undetermined. */
double closedForm(const std::vector<Eigen::Vector2f>& positions,
                  const std::vector<Eigen::Vector2f>& flow,
                  const std::vector<float>& weights,
                  const std::vector<float>& inlier,
                  PlanarMotion& motion)
{
  WeightedSums s;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const double w = static_cast<double>(weights[i]) * inlier[i];
    s.weight += w;
    s.from += w * positions[i].cast<double>();
    s.to += w * (positions[i] + flow[i]).cast<double>();
  }
  if (s.weight < 1e-9)
  {
    return 0;
  }
  const Eigen::Vector2d from = s.from / s.weight;
  const Eigen::Vector2d to = s.to / s.weight;
  double dot = 0;
  double cross = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const double w = static_cast<double>(weights[i]) * inlier[i];
    const Eigen::Vector2d a = positions[i].cast<double>() - from;
    const Eigen::Vector2d b = (positions[i] + flow[i]).cast<double>() - to;
    dot += w * a.dot(b);
    cross += w * (a.x() * b.y() - a.y() * b.x());
  }
  motion.yaw = std::hypot(dot, cross) > 1e-9 ? std::atan2(cross, dot) : 0;
  motion.translation = to - Eigen::Rotation2Dd(motion.yaw) * from;
  return s.weight;
}

void updateInlierWeights(const std::vector<Eigen::Vector2f>& positions,
                         const std::vector<Eigen::Vector2f>& flow,
                         const PlanarMotion& motion,
                         double width,
                         std::vector<float>& inlier)
{
  const double scale = width * width;
  const Eigen::Rotation2Dd turn(motion.yaw);
  const Eigen::Matrix2f R = turn.toRotationMatrix().cast<float>();
  const Eigen::Vector2f t = motion.translation.cast<float>();
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const double error = (R * positions[i] + t - positions[i] - flow[i]).squaredNorm();
    const double share = scale / (scale + error);
    inlier[i] = static_cast<float>(share * share);
  }
}
}  // namespace

Pose PlanarMotion::pose() const
{
  return poseFromYpr(translation.x(), translation.y(), 0, yaw, 0, 0);
}

PlanarMotion PlanarMotion::fromPose(const Pose& pose)
{
  PlanarMotion motion;
  motion.translation = pose.translation().head<2>();
  motion.yaw = yawPitchRoll(pose).x();
  return motion;
}

RigidFlowFit fitRigidFlow(const std::vector<Eigen::Vector2f>& positions,
                          const std::vector<Eigen::Vector2f>& flow,
                          const std::vector<float>& weights,
                          double width,
                          double start_width,
                          const PlanarMotion* start)
{
  RigidFlowFit fit;
  fit.inlier.assign(positions.size(), 1.0F);
  if (start != nullptr)
  {
    fit.motion = *start;
  }
  const auto usable = std::count_if(weights.begin(), weights.end(), [](float w) { return w > 0; });
  if (usable < 3)
  {
    return fit;
  }
  if (start != nullptr)
  {
    updateInlierWeights(positions, flow, fit.motion, start_width, fit.inlier);
  }
  double current = start_width;
  for (int left = final_iterations; left > 0;)
  {
    if (closedForm(positions, flow, weights, fit.inlier, fit.motion) <= 0)
    {
      return fit;
    }
    updateInlierWeights(positions, flow, fit.motion, current, fit.inlier);
    left -= current <= width ? 1 : 0;
    current = std::max(width, annealing_factor * current);
  }
  double in = 0;
  double squares = 0;
  for (std::size_t i = 0; i < positions.size(); ++i)
  {
    const double w = weights[i];
    in += w * fit.inlier[i];
    squares += w * fit.inlier[i] * (fit.motion.flowAt(positions[i]) - flow[i]).squaredNorm();
  }
  fit.rmse = in > 0 ? std::sqrt(squares / in) : 0;
  fit.converged = in > 0;
  return fit;
}
}  // namespace dyslam
