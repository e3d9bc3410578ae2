// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorType.h>
#include <dyslam/backend/factors/GravityFactor.h>

#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::size_t upwards_at = 4;  // in FactorData::further
}  // namespace

const FactorType GravityFactor::factor_type = {
    "gravity",
    "GRAVITY",
    nullptr,
    6,
    [](FactorData& data, FactorFields& fields)
    {
      data.keys.resize(3);
      fields.index(data.keys[0].index);
      fields.vector(&data.further[upwards_at]);
    },
    [](const FactorData& data) -> std::unique_ptr<const Factor>
    {
      return std::make_unique<GravityFactor>(static_cast<std::size_t>(data.keys.at(0).index),
                                             Eigen::Vector3d(&data.further[upwards_at]),
                                             data.information);
    }};

GravityFactor::GravityFactor(std::size_t keyframe,
                             const Eigen::Vector3d& upwards,
                             const Matrix6& information,
                             const Key& bias)
    : Factor(factor_type, {Key::ego(keyframe), Key::vertical(), bias}, information),
      upwards_(upwards)
{
  if (!upwards.allFinite())
  {
    throw std::invalid_argument("factor " + toString(keys()[0]) + " -> " + toString(keys()[1]) +
                                ": its acceleration has numbers that are not finite");
  }
}

Vector6 GravityFactor::residual(ValueBlocks blocks, FactorJacobians* jacobians) const
{
  const Eigen::Matrix3d R_map_vehicle = unpackPose(blocks[0]).linear();
  const Eigen::Matrix3d R_level_map = unpackPose(blocks[1]).linear();
  const Eigen::Map<const Eigen::Vector3d> bias(blocks[2]);
  const Eigen::Vector3d up = (upwards_ - bias) / standard_gravity;
  const Eigen::Vector3d up_map = R_map_vehicle * up;
  Vector6 residual = Vector6::Zero();
  residual.head<2>() = (R_level_map * up_map).head<2>();
  residual.segment<3>(2) = bias;
  if (jacobians != nullptr)
  {
    const Eigen::Matrix3d R_level_vehicle = R_level_map * R_map_vehicle;
    Matrix6& by_vehicle = (*jacobians)[0];
    by_vehicle.setZero();
    by_vehicle.block<2, 3>(0, 3) = -(R_level_vehicle * skew(up)).topRows<2>();
    Matrix6& by_vertical = (*jacobians)[1];
    by_vertical.setZero();
    by_vertical.block<2, 3>(0, 3) = -(R_level_map * skew(up_map)).topRows<2>();
    Matrix6& by_bias = (*jacobians)[2];
    by_bias.setZero();
    by_bias.block<2, 3>(0, 0) = -R_level_vehicle.topRows<2>() / standard_gravity;
    by_bias.block<3, 3>(2, 0).setIdentity();
  }
  return residual;
}

FactorData GravityFactor::data() const
{
  FactorData data = Factor::data();
  Eigen::Map<Eigen::Vector3d>{&data.further[upwards_at]} = upwards_;
  return data;
}
}  // namespace dyslam
