// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/tracking/KalmanMotion.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
constexpr std::size_t history_length = 50;  // more than SignificantMotion needs at 40 Hz
}

KalmanMotion::KalmanMotion(const KalmanOptions& options) : options_(options)
{
  if (!(options.speed_sigma > 0) || !(options.velocity_walk > 0))
  {
    throw std::invalid_argument("KalmanMotion: speed_sigma and velocity_walk must be positive");
  }
}

void KalmanMotion::propagate(double dt, Eigen::Vector4d& state, Eigen::Matrix4d& covariance) const
{
  Eigen::Matrix4d transition = Eigen::Matrix4d::Identity();
  transition.topRightCorner<2, 2>() = dt * Eigen::Matrix2d::Identity();
  state = transition * state;
  covariance = (transition * covariance * transition.transpose()).eval();
  const double q = options_.velocity_walk * options_.velocity_walk;
  for (int axis = 0; axis < 2; ++axis)
  {
    covariance(axis, axis) += q * dt * dt * dt / 3;
    covariance(axis, axis + 2) += q * dt * dt / 2;
    covariance(axis + 2, axis) += q * dt * dt / 2;
    covariance(axis + 2, axis + 2) += q * dt;
  }
}

bool KalmanMotion::add(const TimedPosition& observation, const Eigen::Matrix2d& covariance)
{
  if (!std::isfinite(observation.stamp) || !observation.position.allFinite() ||
      !covariance.allFinite() || (!history_.empty() && observation.stamp <= history_.back().stamp))
  {
    return false;
  }
  noise_ = covariance;
  if (history_.empty())
  {
    state_ << observation.position, 0, 0;
    covariance_.setZero();
    covariance_.topLeftCorner<2, 2>() = covariance;
    covariance_.bottomRightCorner<2, 2>() =
        options_.speed_sigma * options_.speed_sigma * Eigen::Matrix2d::Identity();
  }
  else
  {
    propagate(observation.stamp - history_.back().stamp, state_, covariance_);
    const Eigen::Matrix2d innovation_covariance = covariance_.topLeftCorner<2, 2>() + covariance;
    const Eigen::Matrix<double, 4, 2> gain =
        covariance_.leftCols<2>() * innovation_covariance.inverse();
    state_ += gain * (observation.position - state_.head<2>());
    covariance_ -= (gain * covariance_.topRows<2>()).eval();
    covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
  }
  history_.push_back(observation);
  if (history_.size() > history_length)
  {
    history_.pop_front();
  }
  return true;
}

MotionPrediction KalmanMotion::predict(double stamp) const
{
  MotionPrediction prediction;
  if (history_.empty() || !std::isfinite(stamp))
  {
    return prediction;
  }
  Eigen::Vector4d state = state_;
  Eigen::Matrix4d covariance = covariance_;
  propagate(std::max(0.0, stamp - history_.back().stamp), state, covariance);
  prediction.valid = true;
  prediction.position = state.head<2>();
  prediction.velocity = state.tail<2>();
  prediction.covariance = covariance.topLeftCorner<2, 2>() + noise_;
  prediction.velocity_covariance = covariance.bottomRightCorner<2, 2>();
  prediction.degree = 1;
  prediction.samples = history_.size();
  return prediction;
}

Eigen::Matrix2d KalmanMotion::positionCovariance() const
{
  return covariance_.topLeftCorner<2, 2>();
}

void KalmanMotion::shift(const Eigen::Vector2d& offset)
{
  state_.head<2>() += offset;
  for (TimedPosition& observation : history_)
  {
    observation.position += offset;
  }
}

void KalmanMotion::exchangeState(StateArchive& archive)
{
  archive(options_, history_, state_, covariance_, noise_);
}
}  // namespace dyslam
