// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/odometry/MotionFilter.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
/** Lower limit of the sigma of a prediction [m], [rad]. */
constexpr double floor_sigma = 1e-3;
constexpr double floor_sigma_angle = 1e-4;
}  // namespace

void MotionFilterOptions::describe(OptionsVisitor& v)
{
  v.real("acceleration_sigma", acceleration_sigma, 1e-3, 1e4,
         "sigma of the vehicle's acceleration [m/s^2]");
  v.degrees("angular_acceleration_sigma_deg_s2", angular_acceleration_sigma, 0.01, 1e6,
            "sigma of the vehicle's angular acceleration [deg/s^2]");
  v.real("start_speed_sigma", start_speed_sigma, 1e-3, 1e3,
         "sigma of the velocity at the first scan, if that is not known [m/s]");
  v.degrees("start_turn_rate_sigma_deg_s", start_turn_rate_sigma, 0.01, 1e4,
            "sigma of the angular velocity at the first scan [deg/s]");
  v.renamed("acceleration", "acceleration_sigma");
  v.renamed("angular_acceleration_deg", "angular_acceleration_sigma_deg_s2");
  v.renamed("start_turn_rate_sigma_deg", "start_turn_rate_sigma_deg_s");
}

MotionFilter::MotionFilter(const MotionFilterOptions& options) : options_(options)
{
  validate(options_, "motion");
}

void MotionFilter::start(const Vector6& velocity, double sigma, double angular_sigma)
{
  velocity_ = velocity;
  covariance_.setZero();
  covariance_.diagonal().segment<3>(6).setConstant(sigma * sigma);
  covariance_.diagonal().segment<3>(9).setConstant(angular_sigma * angular_sigma);
}

Pose MotionFilter::predict(double dt) const
{
  return dt > 0 ? expSE3(dt * velocity_) : Pose::Identity();
}

MotionFilter::Matrix12 MotionFilter::predictedCovariance(double dt) const
{
  Matrix12 F = Matrix12::Identity();
  F.topLeftCorner<6, 6>() = adjointSE3(predict(dt).inverse());
  F.topRightCorner<6, 6>().diagonal().setConstant(dt);
  Matrix12 P = F * covariance_ * F.transpose();
  Vector6 noise;
  noise.head<3>().setConstant(options_.acceleration_sigma * options_.acceleration_sigma);
  noise.tail<3>().setConstant(options_.angular_acceleration_sigma *
                              options_.angular_acceleration_sigma);
  P.topLeftCorner<6, 6>().diagonal() += 0.25 * dt * dt * dt * dt * noise;
  P.topRightCorner<6, 6>().diagonal() += 0.5 * dt * dt * dt * noise;
  P.bottomLeftCorner<6, 6>().diagonal() += 0.5 * dt * dt * dt * noise;
  P.bottomRightCorner<6, 6>().diagonal() += dt * dt * noise;
  P.diagonal().head<3>().array() += floor_sigma * floor_sigma;
  P.diagonal().segment<3>(3).array() += floor_sigma_angle * floor_sigma_angle;
  return 0.5 * (P + P.transpose());
}

Matrix6 MotionFilter::information(double dt) const
{
  const Matrix6 P = predictedCovariance(std::max(dt, 0.0)).topLeftCorner<6, 6>();
  return P.llt().solve(Matrix6::Identity());
}

double MotionFilter::sigma(double dt) const
{
  const Eigen::Matrix3d P = predictedCovariance(std::max(dt, 0.0)).topLeftCorner<3, 3>();
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(P).eigenvalues().maxCoeff());
}

void MotionFilter::update(double dt,
                          const Pose& T_previous_current,
                          const Matrix6& measured,
                          const Vector6& prior_weight)
{
  if (dt <= 0)
  {
    return;
  }
  // A component of the prior with a lower robust weight is less certain.
  const Vector6 wider = prior_weight.cwiseSqrt().cwiseInverse();
  Eigen::Matrix<double, 12, 1> scale;
  scale << wider, wider;
  const Matrix12 P = scale.asDiagonal() * predictedCovariance(dt) * scale.asDiagonal();
  const Vector6 correction = logSE3(predict(dt).inverse() * T_previous_current);
  velocity_ += P.bottomLeftCorner<6, 6>() * P.topLeftCorner<6, 6>().llt().solve(correction);

  // The measurement as six numbers of unit variance, uninformative ones among them, and Joseph's
  // form, which keeps the covariance positive definite despite rounding.
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(0.5 * (measured + measured.transpose()));
  Eigen::Matrix<double, 6, 12> H = Eigen::Matrix<double, 6, 12>::Zero();
  H.leftCols<6>() =
      solver.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * solver.eigenvectors().transpose();
  const Matrix6 S = H * P * H.transpose() + Matrix6::Identity();
  const Eigen::Matrix<double, 12, 6> K = S.llt().solve(H * P).transpose();
  const Matrix12 rest = Matrix12::Identity() - K * H;
  covariance_ = rest * P * rest.transpose() + K * K.transpose();
}

void MotionFilter::follow(double dt, const Pose& T_previous_current)
{
  if (dt <= 0)
  {
    return;
  }
  velocity_ = logSE3(T_previous_current) / dt;
  covariance_.setZero();
}

void MotionFilter::forget(double dt)
{
  start(velocity_, std::min(options_.start_speed_sigma, options_.acceleration_sigma * dt),
        std::min(options_.start_turn_rate_sigma, options_.angular_acceleration_sigma * dt));
}

void MotionFilter::exchangeState(StateArchive& archive)
{
  archive(velocity_, covariance_);
}
}  // namespace dyslam
