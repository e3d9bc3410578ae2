// SPDX-License-Identifier: BSD-3-Clause
#include "StreetVehicles.h"

#include <algorithm>
#include <cmath>

namespace dyslam::sim
{
void StreetVehicles::order()
{
  on_lane_.assign(net_.lanes.size(), {});
  for (std::size_t i = 0; i < vehicles_.size(); ++i)
  {
    on_lane_[static_cast<std::size_t>(vehicles_[i].lane)].push_back(static_cast<int>(i));
  }
  for (auto& list : on_lane_)
  {
    std::sort(list.begin(), list.end(), [&](int a, int b) { return at(a).s < at(b).s; });
  }
}

int StreetVehicles::first(int lane) const
{
  return on(lane).empty() ? -1 : on(lane).back();
}

const StreetVehicle* StreetVehicles::last(int lane) const
{
  return on(lane).empty() ? nullptr : &at(on(lane).front());
}

StreetVehicles::Ahead StreetVehicles::leader(const StreetVehicle& v) const
{
  for (const int i : on(v.lane))
  {
    const StreetVehicle& o = at(i);
    if (o.s > v.s && &o != &v)
    {
      return {o.s - v.s - 0.5 * (o.length + v.length), o.v};
    }
  }
  double ahead = lane(v.lane).path.length() - v.s;
  int next = nextLane(v);
  for (int hop = 0; hop < 3 && next >= 0 && ahead < 70; ++hop)
  {
    if (const StreetVehicle* o = last(next))
    {
      return {ahead + o->s - 0.5 * (o->length + v.length), o->v};
    }
    ahead += lane(next).path.length();
    next = lane(next).junction >= 0 ? lane(next).next.front() : -1;
  }
  return {};
}

int StreetVehicles::nextLane(const StreetVehicle& v) const
{
  return lane(v.lane).junction >= 0 ? lane(v.lane).next.front() : v.turn;
}

Path::Sample StreetVehicles::along(const StreetVehicle& v, double offset) const
{
  double s = v.s + offset;
  int l = v.lane;
  if (s < 0 && v.previous_lane >= 0)
  {
    return lane(v.previous_lane).path.at(lane(v.previous_lane).path.length() + s);
  }
  for (int hop = 0; hop < 3; ++hop)
  {
    const double length = lane(l).path.length();
    const int next = hop == 0 ? nextLane(v) : lane(l).junction >= 0 ? lane(l).next.front() : -1;
    if (s <= length || next < 0)
    {
      break;
    }
    s -= length;
    l = next;
  }
  return lane(l).path.at(s);
}

bool StreetVehicles::hasRoom(const StreetVehicle& v) const
{
  return std::all_of(
      vehicles_.begin(), vehicles_.end(),
      [&](const StreetVehicle& o)
      { return o.lane != v.lane || std::abs(o.s - v.s) > 0.5 * (o.length + v.length) + 2; });
}
}  // namespace dyslam::sim
