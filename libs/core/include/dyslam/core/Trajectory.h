// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <optional>
#include <vector>

namespace dyslam
{
class StateArchive;

struct StampedPose
{
  double stamp = 0;  //!< UNIX time [s]
  Pose pose = Pose::Identity();
};

/** Poses of one body in one frame, in order of time. */
class Trajectory
{
 public:
  void push_back(double stamp, const Pose& pose);
  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] std::size_t size() const { return poses_.size(); }
  [[nodiscard]] const StampedPose& operator[](std::size_t i) const { return poses_[i]; }
  [[nodiscard]] StampedPose& operator[](std::size_t i) { return poses_[i]; }
  [[nodiscard]] auto begin() const { return poses_.begin(); }
  [[nodiscard]] auto end() const { return poses_.end(); }

  /** Pose at a time by geodesic interpolation; nothing outside [first, last]. */
  [[nodiscard]] std::optional<Pose> at(double stamp) const;
  /** As at(stamp), but nothing unless the poses before and after are within `max_gap` seconds. */
  [[nodiscard]] std::optional<Pose> at(double stamp, double max_gap) const;
  /** Index of the first pose that is not before a time; size() if all are. */
  [[nodiscard]] std::size_t firstNotBefore(double stamp) const;
  /** Index of the pose nearest in time if within `tolerance` seconds. */
  [[nodiscard]] std::optional<std::size_t> nearest(double stamp, double tolerance) const;
  /** Distance travelled up to each pose, as PathLength counts it [m]. */
  [[nodiscard]] std::vector<double> pathLengths() const;
  void exchangeState(StateArchive& archive);

 private:
  std::vector<StampedPose> poses_;
};
}  // namespace dyslam
