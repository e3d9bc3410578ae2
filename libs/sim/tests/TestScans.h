// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/sim/Simulator.h>

#include <cstring>
#include <vector>

namespace dyslam::sim
{
inline SimulatorOptions small(WorldKind world, double traffic)
{
  SimulatorOptions o;
  o.world = world;
  o.sensor = SensorKind::hdl64e;
  o.columns = 400;
  o.traffic = traffic;
  o.loop_length = 300;
  o.seed = 5;
  return o;
}

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b)
{
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline bool sameScan(const SimulatedScan& a, const SimulatedScan& b)
{
  return sameBytes(a.scan.points, b.scan.points) && sameBytes(a.scan.intensity, b.scan.intensity) &&
         sameBytes(a.scan.time, b.scan.time) && sameBytes(a.scan.ring, b.scan.ring) &&
         sameBytes(a.deskewed, b.deskewed) && sameBytes(a.flow, b.flow) &&
         sameBytes(a.label, b.label) && sameBytes(a.moving, b.moving) &&
         a.T_map_vehicle.matrix() == b.T_map_vehicle.matrix() &&
         a.objects.size() == b.objects.size();
}
}  // namespace dyslam::sim
