// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>

namespace dyslam
{
/** Where an object's centre was seen. */
struct TimedPosition
{
  double stamp = 0;                                    //!< [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  //!< x, y in a fixed frame [m]
};

/** Where a fitted motion is at one time. */
struct MotionPrediction
{
  bool valid = false;  //!< false: no history to predict from
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  //!< derivative of the fit (Eq. 5) [m/s]
  /** Of a new sighting about `position` [m^2]: the fit's own uncertainty plus one sighting's
   * noise. */
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();  //!< [m^2/s^2]
  int degree = 0;           //!< in force, after lowering for a short history
  std::size_t samples = 0;  //!< the fit used
};

enum class MotionModel
{
  polynomial,        //!< least squares over the window (Eqs. 2-4)
  constant_velocity  //!< through the last two sightings
};

struct PolynomialOptions
{
  MotionModel model = MotionModel::polynomial;
  int degree = 2;                 //!< 0 to 5
  int window = 30;                //!< sightings kept (K), at least 1
  double prior_sigma = 0.15;      //!< expected noise of one sighting [m]
  double prior_weight = 2;        //!< how many degrees of freedom the prior is worth
  double first_speed_sigma = 5;   //!< of an object seen once [m/s]
  double acceleration_sigma = 3;  //!< doubt when a fit has no spare sightings [m/s^2]
};

/** The last K sightings of one object and polynomials x(t), y(t) through them.
 *
 * The fit is solved by QR on time centred and scaled to [-1, 1]. The degree falls to what the
 * history supports: one less than the number of different stamps. Gaps in time are allowed; stamps
 * must not go back (such a sighting is refused). Not thread-safe.
 */
class PolynomialTrajectory
{
 public:
  static constexpr int max_degree = 5;
  /** \throws std::invalid_argument for a degree or window out of range. */
  explicit PolynomialTrajectory(const PolynomialOptions& options);

  /** Returns false and changes nothing for NaN, or a stamp not after the last one. */
  bool add(const TimedPosition& sighting);
  void clear() { history_.clear(); }
  /** Move the whole history: what was taken for the centre so far was this far off [m]. */
  void shift(const Eigen::Vector2d& offset);

  /** The fit at a time, usually after the last sighting. */
  [[nodiscard]] MotionPrediction predict(double stamp) const;

  [[nodiscard]] std::size_t size() const { return history_.size(); }
  [[nodiscard]] bool full() const;
  [[nodiscard]] const std::deque<TimedPosition>& history() const { return history_; }

 private:
  PolynomialOptions options_;
  std::deque<TimedPosition> history_;
};
}  // namespace dyslam
