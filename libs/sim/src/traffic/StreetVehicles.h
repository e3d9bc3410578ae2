// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "worlds/Roads.h"

namespace dyslam::sim
{
/** A vehicle on a lane of the streets. Its position is an arc length along the lane. */
struct StreetVehicle
{
  int actor = -1;  //!< -1: the ego
  double length = 4.5, width = 1.8;
  int lane = 0, previous_lane = -1;
  double s = 0, v = 0, a = 0;
  double desired_speed = 1;  //!< relative to the speed limit
  double headway = 1.3;      //!< [s]
  int turn = -1;             //!< chosen turn at the next junction
  bool granted = false;      //!< the turn is reserved
  double waiting_since = -1;
  double stop_until = 0, next_stop = 0;
  double blocked_for = 0;
  std::size_t route_step = 0;  //!< position of the ego in LaneNetwork::ego_route
  double wander = 0;           //!< phase of the lateral oscillation in the lane

  [[nodiscard]] bool isEgo() const { return actor < 0; }
};

/** The vehicles on a network of lanes: which of them is ahead of which. */
class StreetVehicles
{
 public:
  /** Distance that stands for "nothing ahead" [m]. */
  static constexpr double far = 1e9;

  explicit StreetVehicles(const LaneNetwork& net) : net_(net) {}

  [[nodiscard]] const Lane& lane(int i) const { return net_.lanes[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::vector<StreetVehicle>& all() { return vehicles_; }
  [[nodiscard]] const std::vector<StreetVehicle>& all() const { return vehicles_; }
  [[nodiscard]] StreetVehicle& at(int i) { return vehicles_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const StreetVehicle& at(int i) const
  {
    return vehicles_[static_cast<std::size_t>(i)];
  }

  /** Sorts the vehicles of each lane by arc length, as first(), last() and leader() need it. */
  void order();
  /** The vehicle that is the farthest along a lane; -1: the lane is empty. */
  [[nodiscard]] int first(int lane) const;
  /** The vehicle at the beginning of a lane; null: the lane is empty. */
  [[nodiscard]] const StreetVehicle* last(int lane) const;

  /** What is ahead of a vehicle on its route. */
  struct Ahead
  {
    double gap = far;  //!< [m]
    double speed = 0;  //!< [m/s]
  };
  /** The next vehicle on the lane of a vehicle and the next three of its route. */
  [[nodiscard]] Ahead leader(const StreetVehicle& v) const;

  /** Lane that a vehicle takes after its own; -1: its lane ends. */
  [[nodiscard]] int nextLane(const StreetVehicle& v) const;
  /** Point of its route. \param offset distance from the vehicle's centre [m], also negative */
  [[nodiscard]] Path::Sample along(const StreetVehicle& v, double offset) const;
  /** Whether a vehicle would have 2 m to those in front of and behind it. */
  [[nodiscard]] bool hasRoom(const StreetVehicle& v) const;

 private:
  [[nodiscard]] const std::vector<int>& on(int lane) const
  {
    return on_lane_[static_cast<std::size_t>(lane)];
  }

  const LaneNetwork& net_;
  std::vector<StreetVehicle> vehicles_;
  std::vector<std::vector<int>> on_lane_;
};
}  // namespace dyslam::sim
