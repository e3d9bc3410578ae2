// SPDX-License-Identifier: BSD-3-Clause
#include "Body.h"

#include <cmath>

namespace dyslam::sim
{
namespace
{
Eigen::Affine3d place(double x, double y, double z, double pitch)
{
  return Eigen::Translation3d(x, y, z) *
         Eigen::Affine3d(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()));
}

// A positive rotation about y swings a hanging limb backwards.
void addWalker(const BodyModel& model,
               const BodyState& s,
               const Eigen::Affine3d& body,
               std::vector<BodyPart>& parts)
{
  const double vertical_offset = 0.012 * s.swing * std::cos(2 * s.phase);
  parts.push_back({model.shapes[0], body * place(0, 0, vertical_offset, 0.06 * s.swing)});
  for (const double side : {-1.0, 1.0})
  {
    const double a = s.phase + (side > 0 ? M_PI : 0.0);
    parts.push_back({model.shapes[1], body * place(0, side * 0.145, 0.80 + vertical_offset,
                                                   -0.55 * s.swing * std::sin(a))});
  }
  for (const double side : {-1.0, 1.0})
  {
    const double a = s.phase + (side > 0 ? 0.0 : M_PI);
    const double hip = 0.48 * s.swing * std::sin(a);
    const double knee = s.swing * (0.12 + 0.75 * std::max(0.0, std::cos(a)) * 0.9);
    const Eigen::Affine3d thigh = body * place(0, side * 0.055, 0.52 + vertical_offset, -hip);
    parts.push_back({model.shapes[2], thigh});
    parts.push_back({model.shapes[3], thigh * place(0, 0, -0.25, knee)});
  }
  if (model.shapes.size() > 4)
  {
    parts.push_back({model.shapes[4], body * place(model.luggage_x, 0, 0, 0)});
  }
}

// Thigh and shank of fixed lengths between hip and pedal: the knee follows from the law of cosines.
void addCyclist(const BodyModel& model,
                const BodyState& s,
                const Eigen::Affine3d& body,
                std::vector<BodyPart>& parts)
{
  parts.push_back({model.shapes[0], body});
  constexpr double kScale = 1.75, kThigh = 0.25 * kScale, kShank = 0.24 * kScale;
  for (const double side : {-1.0, 1.0})
  {
    const double a = s.phase + (side > 0 ? 0.0 : M_PI);
    const Eigen::Vector2d hip(-0.19, 0.93);
    const Eigen::Vector2d pedal(-0.05 + 0.17 * std::cos(a), 0.36 - 0.17 * std::sin(a));
    const Eigen::Vector2d d = pedal - hip;
    const double reach = std::min(d.norm(), kThigh + kShank - 1e-3);
    const double hip_angle =
        std::acos((kThigh * kThigh + reach * reach - kShank * kShank) / (2 * kThigh * reach));
    const double inner =
        std::acos((kThigh * kThigh + kShank * kShank - reach * reach) / (2 * kThigh * kShank));
    // Angle of the hanging limb: 0 straight down, positive backwards.
    const double line = std::atan2(-d.x(), -d.y());
    const Eigen::Affine3d thigh = body * place(hip.x(), side * 0.1, hip.y(), line - hip_angle);
    parts.push_back({model.shapes[1], thigh * Eigen::Scaling(kScale)});
    parts.push_back(
        {model.shapes[2], thigh * place(0, 0, -kThigh, M_PI - inner) * Eigen::Scaling(kScale)});
  }
}
}  // namespace

Pose bodyPose(const BodyState& s)
{
  return poseFromYpr(s.position.x(), s.position.y(), s.position.z(), s.yaw, s.pitch, s.roll);
}

std::vector<BodyPart> bodyParts(const BodyModel& model, const BodyState& state)
{
  std::vector<BodyPart> parts;
  const Eigen::Affine3d body(bodyPose(state).matrix());
  switch (model.gait)
  {
    case BodyModel::Gait::rigid:
      parts.push_back({model.shapes[0], body * Eigen::Scaling(model.scale)});
      break;
    case BodyModel::Gait::walking:
      addWalker(model, state, body * Eigen::Scaling(model.scale), parts);
      break;
    case BodyModel::Gait::cycling:
      addCyclist(model, state, body, parts);
      break;
  }
  return parts;
}
}  // namespace dyslam::sim
