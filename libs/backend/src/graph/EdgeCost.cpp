// SPDX-License-Identifier: BSD-3-Clause
#include "EdgeCost.h"

#include <dyslam/base/Angle.h>

#include <Eigen/Cholesky>
#include <array>

namespace dyslam
{
namespace
{
using RowMatrix67 = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;
using RowMatrix33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

class EdgeCost final : public ceres::SizedCostFunction<6, pose_block_size, pose_block_size>
{
 public:
  EdgeCost(ErrorCoordinates coordinates, const GraphEdge& edge)
      : coordinates_(coordinates),
        T_measured_(edge.T_from_to),
        whitening_(edge.information.llt().matrixU())
  {
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override
  {
    const Pose T_i = unpackPose(blocks[0]);
    const Pose T_j = unpackPose(blocks[1]);
    Eigen::Map<Vector6> whitened(residuals);
    if (jacobians == nullptr)
    {
      whitened = whitening_ * edgeError(coordinates_, T_measured_, T_i, T_j);
      return true;
    }
    Matrix6 by_i;
    Matrix6 by_j;
    whitened = whitening_ * edgeError(coordinates_, T_measured_, T_i, T_j, &by_i, &by_j);
    writeJacobian(jacobians[0], by_i);
    writeJacobian(jacobians[1], by_j);
    return true;
  }

 private:
  void writeJacobian(double* target, const Matrix6& jacobian) const
  {
    if (target != nullptr)
    {
      Eigen::Map<RowMatrix67> block(target);
      block.leftCols<6>().noalias() = whitening_ * jacobian;
      block.col(6).setZero();
    }
  }

  ErrorCoordinates coordinates_;
  Pose T_measured_;
  Matrix6 whitening_;
};

class PlanarEdgeCost final : public ceres::SizedCostFunction<3, 3, 3>
{
 public:
  explicit PlanarEdgeCost(const GraphEdge& edge)
      : translation_(edge.T_from_to.translation().head<2>()),
        heading_(yawPitchRoll(edge.T_from_to).x())
  {
    constexpr std::array<Eigen::Index, 3> at = {0, 1, 5};
    Eigen::Matrix3d information;
    for (Eigen::Index r = 0; r < 3; ++r)
    {
      for (Eigen::Index c = 0; c < 3; ++c)
      {
        information(r, c) =
            edge.information(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]);
      }
    }
    whitening_ = information.llt().matrixU();
  }

  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override
  {
    const Eigen::Map<const Eigen::Vector3d> i(blocks[0]);
    const Eigen::Map<const Eigen::Vector3d> j(blocks[1]);
    // Rows of the rotation from the map to the frame of E = Z^-1 T_i^-1 T_j.
    const Eigen::Rotation2Dd R_j_map(-(i.z() + heading_));
    const Eigen::Matrix2d A = R_j_map.toRotationMatrix();
    const Eigen::Vector2d motion = j.head<2>() - i.head<2>();
    const Eigen::Rotation2Dd back(-heading_);
    Eigen::Vector3d error;
    error.head<2>() = A * motion - back * translation_;
    error.z() = wrapAngle(j.z() - i.z() - heading_);
    Eigen::Map<Eigen::Vector3d>(residuals).noalias() = whitening_ * error;
    if (jacobians == nullptr)
    {
      return true;
    }
    if (jacobians[0] != nullptr)
    {
      Eigen::Matrix3d by_i = Eigen::Matrix3d::Zero();
      by_i.topLeftCorner<2, 2>() = -A;
      const Eigen::Vector2d turned = A * motion;
      by_i(0, 2) = turned.y();
      by_i(1, 2) = -turned.x();
      by_i(2, 2) = -1;
      Eigen::Map<RowMatrix33>(jacobians[0]).noalias() = whitening_ * by_i;
    }
    if (jacobians[1] != nullptr)
    {
      Eigen::Matrix3d by_j = Eigen::Matrix3d::Zero();
      by_j.topLeftCorner<2, 2>() = A;
      by_j(2, 2) = 1;
      Eigen::Map<RowMatrix33>(jacobians[1]).noalias() = whitening_ * by_j;
    }
    return true;
  }

 private:
  Eigen::Vector2d translation_;
  double heading_;
  Eigen::Matrix3d whitening_;
};
}  // namespace

std::unique_ptr<ceres::CostFunction> makeEdgeCost(ErrorCoordinates coordinates,
                                                  const GraphEdge& edge)
{
  return std::make_unique<EdgeCost>(coordinates, edge);
}

std::unique_ptr<ceres::CostFunction> makePlanarEdgeCost(const GraphEdge& edge)
{
  return std::make_unique<PlanarEdgeCost>(edge);
}
}  // namespace dyslam
