// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/MotionAccumulator.h>

#include <Eigen/Eigenvalues>

namespace dyslam
{
namespace
{
/** Covariance of an error of the start pose, over the tangent of the end pose. */
Matrix6 carried(const Matrix6& covariance, const Pose& T_start_end)
{
  const Matrix6 A = adjointSE3(T_start_end.inverse());
  return A * covariance * A.transpose();
}

/** Nearest positive semidefinite matrix. */
Matrix6 positive(const Matrix6& M)
{
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(0.5 * (M + M.transpose()));
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(0).asDiagonal() *
         solver.eigenvectors().transpose();
}
}  // namespace

void MotionAccumulator::add(const Pose& T_previous_current,
                            const Matrix6& covariance,
                            const Matrix6& pose_noise)
{
  const Matrix6 noise = carried(noise_now_, T_previous_current) + pose_noise;
  drift_ = carried(drift_, T_previous_current) + positive(covariance - noise);
  T_start_now_ = orthonormalised(T_start_now_ * T_previous_current);
  noise_now_ = pose_noise;
  moved_ = true;
}

void MotionAccumulator::restart()
{
  T_start_now_.setIdentity();
  drift_.setZero();
  noise_of_start_ = noise_now_;
  moved_ = false;
}

Matrix6 MotionAccumulator::covariance() const
{
  if (!moved_)
  {
    return Matrix6::Zero();
  }
  return drift_ + carried(noise_of_start_, T_start_now_) + noise_now_;
}

void MotionAccumulator::exchangeState(StateArchive& archive)
{
  archive(T_start_now_, drift_, noise_of_start_, noise_now_, moved_);
}
}  // namespace dyslam
