// SPDX-License-Identifier: BSD-3-Clause
#include "Benchmark.h"

#include <dyslam/core/Error.h>

namespace dyslam::sim
{
namespace
{
NamedRecording make(const std::string& name,
                    WorldKind world,
                    SensorKind sensor,
                    double traffic,
                    double loop,
                    double seconds,
                    int seed)
{
  NamedRecording r;
  r.name = name;
  SimulatorOptions& o = r.recording.simulator;
  o.world = world;
  o.sensor = sensor;
  o.traffic = traffic;
  o.loop_length = loop;
  o.seed = seed;
  o.columns = sensor == SensorKind::vlp16 ? 0 : 1024;
  r.recording.seconds = seconds;
  r.recording.flow = false;
  r.recording.compact = true;
  r.recording.compression_level = 4;
  return r;
}

void addWithAndWithoutTraffic(std::vector<NamedRecording>& set, NamedRecording base)
{
  NamedRecording empty = base;
  base.name += "_traffic";
  empty.name += "_empty";
  empty.recording.simulator.traffic = 0;
  set.push_back(std::move(base));
  set.push_back(std::move(empty));
}
}  // namespace

std::vector<NamedRecording> benchmarkSet(const std::string& dir, const std::string& only)
{
  std::vector<NamedRecording> set;
  NamedRecording urban =
      make("urban_loop", WorldKind::urban, SensorKind::hdl64e, 0.35, 1700, 900, 101);
  urban.recording.one_loop = true;
  urban.recording.simulator.ego_speed = 13;
  addWithAndWithoutTraffic(set, urban);
  NamedRecording campus =
      make("campus_loop", WorldKind::campus, SensorKind::vlp16, 0.5, 400, 600, 102);
  campus.recording.one_loop = true;
  campus.recording.simulator.ego_speed = 1.8;
  addWithAndWithoutTraffic(set, campus);
  NamedRecording highway =
      make("highway_dense", WorldKind::highway, SensorKind::hdl64e, 0.6, 2400, 60, 103);
  highway.recording.simulator.ego_speed = 28;
  addWithAndWithoutTraffic(set, highway);
  addWithAndWithoutTraffic(set,
                           make("jam", WorldKind::highway, SensorKind::hdl64e, 1.0, 2400, 60, 104));

  std::vector<NamedRecording> chosen;
  std::vector<std::string> names;
  for (auto& r : set)
  {
    names.push_back(r.name);
    if (only.empty() || only == r.name)
    {
      r.recording.output = dir + "/" + r.name + ".rawlog";
      chosen.push_back(r);
    }
  }
  if (chosen.empty())
  {
    std::string all;
    for (const auto& n : names)
    {
      all += (all.empty() ? "" : ", ") + n;
    }
    throw UserError("--only: '" + only + "' is none of " + all);
  }
  return chosen;
}
}  // namespace dyslam::sim
