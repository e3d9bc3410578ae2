// SPDX-License-Identifier: BSD-3-Clause
#include "StreetJunctions.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
std::vector<StreetJunctions::User>& StreetJunctions::usersOf(int turn)
{
  return users_[static_cast<std::size_t>(vehicles_.lane(turn).junction)];
}

void StreetJunctions::grantTurns(double time)
{
  collectUsers();
  for (const int i : waitingVehicles(time))
  {
    StreetVehicle& v = vehicles_.at(i);
    std::vector<User>& users = usersOf(v.turn);
    if (!conflicts(v.turn, users) && exitIsFree(v, users))
    {
      v.granted = true;
      users.push_back({i, v.turn});
    }
    else if (time - v.waiting_since > 5)
    {
      users.push_back({i, v.turn});  // this vehicle has priority over later ones
    }
  }
}

void StreetJunctions::collectUsers()
{
  users_.assign(static_cast<std::size_t>(net_.junctions), {});
  for (std::size_t i = 0; i < vehicles_.all().size(); ++i)
  {
    const int turn = reservedTurn(vehicles_.all()[i]);
    if (turn >= 0 && vehicles_.lane(turn).junction >= 0)
    {
      usersOf(turn).push_back({static_cast<int>(i), turn});
    }
  }
}

/** The turn of a vehicle from its grant until its rear has left it; -1: none. */
int StreetJunctions::reservedTurn(const StreetVehicle& v) const
{
  if (vehicles_.lane(v.lane).junction >= 0)
  {
    return v.lane;
  }
  if (v.granted)
  {
    return v.turn;
  }
  const bool leaves_turn = v.previous_lane >= 0 && vehicles_.lane(v.previous_lane).junction >= 0 &&
                           v.s < 0.5 * v.length + 1.0;
  return leaves_turn ? v.previous_lane : -1;
}

/** The first vehicle of each lane that is near a junction, without a grant and without a red light,
 * in the order in which they came. */
std::vector<int> StreetJunctions::waitingVehicles(double time)
{
  std::vector<int> waiting;
  for (std::size_t i = 0; i < vehicles_.all().size(); ++i)
  {
    StreetVehicle& v = vehicles_.all()[i];
    const Lane& lane = vehicles_.lane(v.lane);
    if (lane.junction >= 0 || v.turn < 0 || v.granted || vehicles_.lane(v.turn).junction < 0)
    {
      continue;
    }
    const double rest = lane.path.length() - v.s - 0.5 * v.length;
    const bool is_first = vehicles_.first(v.lane) == static_cast<int>(i);
    if (is_first && rest < v.v * v.v / 4.0 + 8 && !isRed(vehicles_.lane(v.turn), time))
    {
      v.waiting_since = v.waiting_since < 0 ? time : v.waiting_since;
      waiting.push_back(static_cast<int>(i));
    }
  }
  std::sort(waiting.begin(), waiting.end(),
            [&](int a, int b)
            {
              const double since_a = vehicles_.at(a).waiting_since;
              const double since_b = vehicles_.at(b).waiting_since;
              return since_a != since_b ? since_a < since_b : a < b;
            });
  return waiting;
}

/** Whether the traffic light is red for a turn: the two streets have green alternately. */
bool StreetJunctions::isRed(const Lane& turn, double time) const
{
  const auto junction = static_cast<std::size_t>(turn.junction);
  if (net_.light_cycles.empty() || net_.light_cycles[junction] <= 0)
  {
    return false;
  }
  const double begin = 0.37 * turn.junction + 0.5 * turn.axis;  // of green [cycles]
  const double phase = time / net_.light_cycles[junction] - begin;
  return phase - std::floor(phase) > 0.42;
}

bool StreetJunctions::conflicts(int turn, const std::vector<User>& users) const
{
  const std::vector<int>& others = vehicles_.lane(turn).conflicts;
  return std::any_of(users.begin(), users.end(),
                     [&](const User& u)
                     { return std::find(others.begin(), others.end(), u.turn) != others.end(); });
}

/** Whether a vehicle fits behind the last one on the lane that its turn leads to. */
bool StreetJunctions::exitIsFree(const StreetVehicle& v, const std::vector<User>& users) const
{
  const int exit = vehicles_.lane(v.turn).next.front();
  double needed = v.length + 3;
  for (const User& u : users)
  {
    if (vehicles_.lane(u.turn).next.front() == exit)
    {
      needed += vehicles_.at(u.vehicle).length + 3;
    }
  }
  const StreetVehicle* last = vehicles_.last(exit);
  return last == nullptr || last->s - 0.5 * last->length > needed || last->v > 4;
}
}  // namespace dyslam::sim
