// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/GnssFactor.h>

#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::size_t antenna_at = 1;  // in FactorData::further
}  // namespace

const FactorType GnssFactor::factor_type = {
    "gnss",
    "GNSS",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(2);
      fields.index(data.keys[0].index);
      fields.vector(data.measurement.matrix().col(3).data());
      fields.vector(&data.further[antenna_at]);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<GnssFactor>(
          static_cast<std::size_t>(data.keys.at(0).index), data.measurement.translation(),
          Eigen::Vector3d(&data.further[antenna_at]), data.information);
    }};

GnssFactor::GnssFactor(std::size_t keyframe,
                       const Eigen::Vector3d& position,
                       const Eigen::Vector3d& antenna,
                       const Matrix6& information,
                       const Eigen::Vector3d& upwards)
    : Factor(factor_type, {Key::ego(keyframe), Key::georeference()}, information),
      position_(position),
      antenna_(antenna),
      upwards_(upwards)
{
  if (!position.allFinite() || !antenna.allFinite() || !upwards.allFinite())
  {
    throw std::invalid_argument("factor " + toString(keys()[0]) + " -> " + toString(keys()[1]) +
                                ": its position has numbers that are not finite");
  }
}

Vector6 GnssFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  const Pose T_map_vehicle = unpackPose(blocks[0]);
  const Pose T_enu_map = unpackPose(blocks[1]);
  const Eigen::Vector3d in_map = T_map_vehicle * antenna_;
  const Eigen::Matrix3d& R_enu_map = T_enu_map.linear();
  Vector6 residual = Vector6::Zero();
  residual.head<3>() = T_enu_map * in_map - position_;
  residual.segment<2>(3) = (R_enu_map * upwards_).head<2>();
  if (jacobians != nullptr)
  {
    const Eigen::Matrix3d R_enu_vehicle = R_enu_map * T_map_vehicle.linear();
    Matrix6& by_vehicle = (*jacobians)[0];
    by_vehicle.setZero();
    by_vehicle.topLeftCorner<3, 3>() = R_enu_vehicle;
    by_vehicle.topRightCorner<3, 3>() = -R_enu_vehicle * skew(antenna_);
    Matrix6& by_map = (*jacobians)[1];
    by_map.setZero();
    by_map.topLeftCorner<3, 3>() = R_enu_map;
    by_map.topRightCorner<3, 3>() = -R_enu_map * skew(in_map);
    by_map.block<2, 3>(3, 3) = -(R_enu_map * skew(upwards_)).topRows<2>();
  }
  return residual;
}

Pose GnssFactor::measurement() const
{
  Pose pose = Pose::Identity();
  pose.translation() = position_;
  return pose;
}

FactorData GnssFactor::data() const
{
  FactorData data = Factor::data();
  Eigen::Map<Eigen::Vector3d>{&data.further[antenna_at]} = antenna_;
  return data;
}

FactorLoss GnssFactor::loss(const FactorGraphOptions& options) const
{
  return {options.gnss_loss, options.gnss_loss_width};
}
}  // namespace dyslam
