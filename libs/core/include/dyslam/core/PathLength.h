// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace dyslam
{
class StateArchive;

/** Distance travelled along positions that come one after the other.
 *
 * The estimate of a sensor that stands still changes by about a millimetre from scan to scan, which
 * would add up to tens of metres in an hour. A position therefore counts only once it is
 * `dead_band` away from the last one that counted: the length is short by at most that. */
class PathLength
{
 public:
  static constexpr double dead_band = 0.1;  //!< distance below which a position doesn't count [m]

  /** Adds the next position [m]; one that is not finite is ignored. \return length up to it [m] */
  double add(const Eigen::Vector3d& position);
  [[nodiscard]] double length() const { return length_; }
  void exchangeState(StateArchive& archive);

 private:
  double length_ = 0;
  Eigen::Vector3d counted_ = Eigen::Vector3d::Zero();
  bool started_ = false;
};
}  // namespace dyslam
