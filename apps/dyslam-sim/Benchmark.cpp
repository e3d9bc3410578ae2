// SPDX-License-Identifier: BSD-3-Clause
#include "Benchmark.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>

#include <algorithm>
#include <array>

namespace dyslam::sim
{
namespace
{
/** A drive of a set. */
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

NamedRecording make(const std::string& name, const Drive& drive, int seed)
{
  NamedRecording r;
  r.name = name;
  SimulatorOptions& o = r.recording.simulator;
  o.world = drive.world;
  o.sensor = drive.sensor;
  o.traffic = drive.traffic;
  o.ego_speed = drive.speed;
  o.loop_length = drive.loop;
  o.seed = seed;
  o.columns = drive.sensor == SensorKind::hdl64e ? 1024 : 0;
  r.recording.seconds = drive.seconds;
  r.recording.one_loop = drive.closed;
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

// Drives of the splits. As KITTI odometry 00-10 mostly streets in light traffic and one motorway,
// some of them with a loop, and what those lack: a jam, a robot, other sensors. In denser traffic
// the ego mostly stands in queues.
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
  const Drive urban{WorldKind::urban, SensorKind::hdl64e, 0.35, 13, 1700, 900, true};
  const Drive campus{WorldKind::campus, SensorKind::vlp16, 0.5, 1.8, 400, 600, true};
  const Drive highway{WorldKind::highway, SensorKind::hdl64e, 0.6, 28, 2400, 60, false};
  const Drive jam{WorldKind::highway, SensorKind::hdl64e, 1.0, 0, 2400, 60, false};
  std::vector<NamedRecording> set;
  addWithAndWithoutTraffic(set, make("urban_loop", urban, 101));
  addWithAndWithoutTraffic(set, make("campus_loop", campus, 102));
  addWithAndWithoutTraffic(set, make("highway_dense", highway, 103));
  addWithAndWithoutTraffic(set, make("jam", jam, 104));
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
    set.push_back(
        make(split + (number < 10 ? "_0" : "_") + std::to_string(number), drive, first + number));
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
