// SPDX-License-Identifier: BSD-3-Clause
#include "PlainCeres.h"

#include <ceres/ceres.h>
#include <dyslam/mrpt/Conversions.h>

#include <Eigen/Dense>
#include <vector>

#include "graph/GraphData.h"
#include "graph/InitialGuess.h"

namespace dyslam
{
namespace
{
struct AutoDiffError
{
  Eigen::Vector3d translation;
  Eigen::Quaterniond rotation;
  Matrix6 whitening;

  template <typename T>
  bool operator()(const T* p_i, const T* q_i, const T* p_j, const T* q_j, T* residuals) const
  {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Vector> t_i(p_i);
    const Eigen::Map<const Vector> t_j(p_j);
    const Eigen::Map<const Eigen::Quaternion<T>> r_i(q_i);
    const Eigen::Map<const Eigen::Quaternion<T>> r_j(q_j);
    const Eigen::Quaternion<T> back = rotation.conjugate().cast<T>();
    const Eigen::Quaternion<T> turn = back * (r_i.conjugate() * r_j);
    Eigen::Map<Eigen::Matrix<T, 6, 1>> error(residuals);
    error.template head<3>() =
        back * Vector(r_i.conjugate() * Vector(t_j - t_i) - translation.cast<T>());
    error.template tail<3>() = T(turn.w() < T(0) ? -2 : 2) * turn.vec();
    error.applyOnTheLeft(whitening.cast<T>());
    return true;
  }
};
}  // namespace

int solveByPlainCeres(mrpt::graphs::CNetworkOfPoses3DInf& graph, double limit)
{
  GraphData data = unroll(graph, IndefiniteInformation::project);
  completePoses(data);
  std::vector<Eigen::Quaterniond> rotations;
  for (const Pose& pose : data.poses)
  {
    rotations.emplace_back(pose.linear());
  }
  ceres::Problem problem;
  for (const GraphEdge& edge : data.edges)
  {
    auto* error =
        new AutoDiffError{edge.T_from_to.translation(), Eigen::Quaterniond(edge.T_from_to.linear()),
                          edge.information.llt().matrixU()};
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<AutoDiffError, 6, 3, 4, 3, 4>(error), nullptr,
        data.poses[edge.from].matrix().col(3).data(), rotations[edge.from].coeffs().data(),
        data.poses[edge.to].matrix().col(3).data(), rotations[edge.to].coeffs().data());
  }
  for (Eigen::Quaterniond& q : rotations)
  {
    problem.SetManifold(q.coeffs().data(), new ceres::EigenQuaternionManifold);
  }
  problem.SetParameterBlockConstant(data.poses[data.root].matrix().col(3).data());
  problem.SetParameterBlockConstant(rotations[data.root].coeffs().data());
  ceres::Solver::Options options;
  options.max_num_iterations = 200;
  options.max_solver_time_in_seconds = limit;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < data.size(); ++i)
  {
    data.poses[i].linear() = rotations[i].toRotationMatrix();
    static_cast<mrpt::poses::CPose3D&>(graph.nodes[data.ids[i]]) = toMrpt(data.poses[i]);
  }
  return static_cast<int>(summary.iterations.size()) - 1;
}
}  // namespace dyslam
