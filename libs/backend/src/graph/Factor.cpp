// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Factor.h>
#include <dyslam/backend/FactorType.h>

#include <Eigen/Cholesky>
#include <stdexcept>
#include <string>
#include <utility>

namespace dyslam
{
namespace
{
std::string namesOf(const std::vector<Key>& keys)
{
  std::string names;
  for (const Key& key : keys)
  {
    names += (names.empty() ? "" : " -> ") + toString(key);
  }
  return names;
}
}  // namespace

std::string toString(const Key& key)
{
  switch (key.kind)
  {
    case VariableKind::ego_pose:
      return "x" + std::to_string(key.index);
    case VariableKind::static_object:
      return "s" + std::to_string(key.object) +
             (key.index > 0 ? "#" + std::to_string(key.index) : "");
    case VariableKind::object_pose:
      return "l" + std::to_string(key.object) + "@" + std::to_string(key.index);
    case VariableKind::georeference:
      return "g";
    case VariableKind::vertical:
      return "d";
    case VariableKind::accelerometer_bias:
      return "b";
    case VariableKind::prior_map:
      return "m";
    case VariableKind::object_velocity:
      break;
  }
  return "v" + std::to_string(key.object) + "@" + std::to_string(key.index);
}

Factor::Factor(const FactorType& type, std::vector<Key> keys, const Matrix6& information)
    : type_(type), keys_(std::move(keys)), information_(Matrix6::Identity())
{
  if (keys_.empty() || keys_.size() > max_keys_per_factor)
  {
    throw std::invalid_argument(std::string("factor of kind ") + type.name + ": has " +
                                std::to_string(keys_.size()) + " variables, must have 1 to " +
                                std::to_string(max_keys_per_factor));
  }
  information_.topLeftCorner(type.dimension, type.dimension) =
      information.topLeftCorner(type.dimension, type.dimension);
  for (std::size_t i = 0; i < keys_.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      if (keys_[i] == keys_[j])
      {
        throw std::invalid_argument("factor " + namesOf(keys_) + ": connects a variable to itself");
      }
    }
  }
  if (!information_.allFinite())
  {
    throw std::invalid_argument("factor " + namesOf(keys_) +
                                ": its information has numbers that are not finite");
  }
  const Eigen::LLT<Matrix6> cholesky(information_);
  if (cholesky.info() != Eigen::Success || !information_.isApprox(information_.transpose(), 1e-6))
  {
    throw std::invalid_argument("factor " + namesOf(keys_) +
                                ": its information is not positive definite");
  }
  whitening_ = cholesky.matrixU();
}

Vector6 Factor::whitenedResidual(ValueBlocks blocks) const
{
  return whitening_ * residual(blocks, nullptr);
}

FactorLoss Factor::loss(const FactorGraphOptions& /*options*/) const
{
  return {};
}

FactorData Factor::data() const
{
  FactorData data;
  data.keys = keys_;
  data.measurement = measurement();
  data.information = information_;
  return data;
}

void packPose(const Pose& pose, double* block)
{
  Eigen::Map<Eigen::Vector3d>{block} = pose.translation();
  Eigen::Map<Eigen::Quaterniond>{block + 3} = Eigen::Quaterniond(pose.linear());
}

Pose unpackPose(const double* block)
{
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(block);
  pose.linear() = Eigen::Map<const Eigen::Quaterniond>(block + 3).toRotationMatrix();
  return pose;
}
}  // namespace dyslam
