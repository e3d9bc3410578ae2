// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/sim/SimulatorOptions.h>

#include <utility>

namespace dyslam::sim
{
namespace
{
constexpr std::initializer_list<std::pair<const char*, WorldKind>> kWorlds{
    {"urban", WorldKind::urban},
    {"campus", WorldKind::campus},
    {"highway", WorldKind::highway},
    {"tunnel", WorldKind::tunnel},
    {"field", WorldKind::field}};
}  // namespace

void SimulatorOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("world", world, kWorlds, "kind of place");
  visitor.choice("sensor", sensor,
                 {{"HDL64E", SensorKind::hdl64e},
                  {"HDL32E", SensorKind::hdl32e},
                  {"VLP16", SensorKind::vlp16},
                  {"OS1-64", SensorKind::os1_64},
                  {"OS1-128", SensorKind::os1_128}},
                 "spinning LiDAR");
  visitor.real("traffic", traffic, 0, 1, "0 nothing moves .. 1 jammed");
  visitor.integer("seed", seed, 0, 2147483647, "world, traffic and noise");
  visitor.choice("ego", ego,
                 {{"automatic", EgoKind::automatic},
                  {"car", EgoKind::car},
                  {"robot", EgoKind::robot},
                  {"handheld", EgoKind::handheld}},
                 "what carries the sensor; automatic is a robot on campus and a car elsewhere");
  visitor.real("ego_speed", ego_speed, 0, 40, "cruising speed [m/s]; 0 takes what suits the world");
  visitor.real("loop_length", loop_length, 50, 10000, "about how long the ego's loop is [m]");
  visitor.real("start_time", start_time, 0, 600, "simulated before the first scan [s]");
  visitor.real("start_fraction", start_fraction, 0, 1, "where on its loop the ego starts");
  visitor.flag("stops", stops, "the ego stops now and then");
  visitor.flag("motion_distortion", motion_distortion, "points are taken while the sensor moves");
  visitor.flag("noise", noise, "range noise, losses, mixed pixels");
  visitor.integer("columns", columns, 0, 8192, "firings in one turn; 0 takes the sensor's");
  visitor.real("max_range", max_range, 0, 300, "[m]; 0 takes the sensor's");
  visitor.real("moving_speed", moving_speed, 0, 10, "bodies faster than this are moving [m/s]");
}

WorldKind worldKindFromString(const std::string& name)
{
  std::vector<std::string> words;
  for (const auto& [text, kind] : kWorlds)
  {
    if (name == text)
    {
      return kind;
    }
    words.emplace_back(text);
  }
  const std::string near = nearestWord(name, words);
  throw UserError("world: '" + name + "' is none of urban, campus, highway, tunnel, field" +
                  (near.empty() ? "" : "; did you mean " + near + "?"));
}

std::string toString(WorldKind kind)
{
  for (const auto& [text, candidate] : kWorlds)
  {
    if (candidate == kind)
    {
      return text;
    }
  }
  return "?";
}
}  // namespace dyslam::sim
