// SPDX-License-Identifier: BSD-3-Clause
#include "Benchmark.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>

#include <array>

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
  o.columns = sensor == SensorKind::hdl64e ? 1024 : 0;
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

void setPaths(std::vector<NamedRecording>& set, const std::string& dir)
{
  for (NamedRecording& one : set)
  {
    one.recording.output = dir + "/" + one.name + ".rawlog";
  }
}

/** A drive of the sets of splits. Jams are highways in stop and go. */
struct Drive
{
  WorldKind world;
  SensorKind sensor;
  double traffic;
  double speed;    //!< cruising [m/s]; 0 for the default of the world
  double loop;     //!< [m]
  double seconds;  //!< at most, if the loop is closed
  bool closed;     //!< goes on until its loop is closed
};

// As KITTI odometry 00-10 mostly streets in light traffic and one motorway, some of them with a
// loop, and what those lack: a jam, a robot, other sensors. In denser traffic the ego mostly stands
// in queues.
constexpr std::array<Drive, 11> drives{{
    {WorldKind::urban, SensorKind::hdl64e, 0.25, 11, 900, 60, false},     // 00 street
    {WorldKind::highway, SensorKind::hdl64e, 0.30, 28, 2400, 45, false},  // 01 highway
    {WorldKind::urban, SensorKind::hdl64e, 0.20, 12, 1200, 60, false},    // 02 street
    {WorldKind::urban, SensorKind::hdl64e, 0.04, 10, 700, 50, false},     // 03 street, nearly empty
    {WorldKind::urban, SensorKind::hdl64e, 0.30, 13, 900, 50, false},     // 04 street
    {WorldKind::urban, SensorKind::hdl64e, 0.20, 10, 260, 120, true},     // 05 street, loop
    {WorldKind::highway, SensorKind::hdl64e, 1.00, 0, 2400, 60, false},   // 06 jam
    {WorldKind::urban, SensorKind::hdl64e, 0.15, 11, 260, 120, true},     // 07 street, loop
    {WorldKind::highway, SensorKind::hdl64e, 0.60, 28, 2400, 45, false},  // 08 highway, dense
    {WorldKind::campus, SensorKind::vlp16, 0.50, 2.6, 300, 60, false},    // 09 robot on a campus
    {WorldKind::urban, SensorKind::hdl32e, 0.20, 10, 700, 50, false},     // 10 street
}};
/** Least distance of a recording without a loop [m]: the shortest segment of t_rel and half of it.
 */
constexpr double least_distance = 150;
constexpr int first_validation_seed = 900000001;
constexpr int first_test_seed = 1200000001;
}  // namespace

std::vector<NamedRecording> standingSet(const std::string& dir)
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
  setPaths(set, dir);
  return set;
}

std::vector<NamedRecording> splitSet(const std::string& dir, const std::string& split)
{
  const std::vector<std::string> splits{"validation", "test"};
  if (std::find(splits.begin(), splits.end(), split) == splits.end())
  {
    throw UserError("--split: " + unknownWord("split", split, splits));
  }
  std::vector<NamedRecording> set;
  for (const Drive& drive : drives)
  {
    const int number = static_cast<int>(set.size());
    const int first = split == "test" ? first_test_seed : first_validation_seed;
    set.push_back(make(split + (number < 10 ? "_0" : "_") + std::to_string(number), drive.world,
                       drive.sensor, drive.traffic, drive.loop, drive.seconds, first + number));
    set.back().recording.simulator.ego_speed = drive.speed;
    set.back().recording.one_loop = drive.closed;
    set.back().recording.least_distance = drive.closed ? 0 : least_distance;
  }
  setPaths(set, dir);
  return set;
}

NamedRecording oneOf(const std::vector<NamedRecording>& set, const std::string& name)
{
  std::vector<std::string> names;
  for (const NamedRecording& one : set)
  {
    if (one.name == name)
    {
      return one;
    }
    names.push_back(one.name);
  }
  throw UserError("--only: " + unknownWord("recording", name, names));
}
}  // namespace dyslam::sim
