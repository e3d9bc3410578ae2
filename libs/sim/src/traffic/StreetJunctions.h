// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "StreetVehicles.h"

namespace dyslam::sim
{
/** Right of way at junctions: grants turns that do not conflict, first come, first served. */
class StreetJunctions
{
 public:
  StreetJunctions(const LaneNetwork& net, StreetVehicles& vehicles) : net_(net), vehicles_(vehicles)
  {
  }

  /** Sets StreetVehicle::granted. \pre StreetVehicles::order() \param time simulated time [s] */
  void grantTurns(double time);

 private:
  /** A vehicle that uses a turn of a junction, or has priority for it. */
  struct User
  {
    int vehicle;
    int turn;
  };

  [[nodiscard]] std::vector<User>& usersOf(int turn);
  void collectUsers();
  [[nodiscard]] int reservedTurn(const StreetVehicle& v) const;
  [[nodiscard]] std::vector<int> waitingVehicles(double time);
  [[nodiscard]] bool isRed(const Lane& turn, double time) const;
  [[nodiscard]] bool conflicts(int turn, const std::vector<User>& users) const;
  [[nodiscard]] bool exitIsFree(const StreetVehicle& v, const std::vector<User>& users) const;

  const LaneNetwork& net_;
  StreetVehicles& vehicles_;
  std::vector<std::vector<User>> users_;  //!< by junction
};
}  // namespace dyslam::sim
