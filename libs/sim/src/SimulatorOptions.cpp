// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Words.h>
#include <dyslam/sim/SimulatorOptions.h>

#include <utility>

namespace dyslam::sim
{
namespace
{
constexpr std::initializer_list<std::pair<const char*, WorldKind>> kWorlds{
    {"urban", WorldKind::urban},   {"campus", WorldKind::campus}, {"highway", WorldKind::highway},
    {"tunnel", WorldKind::tunnel}, {"field", WorldKind::field},   {"downtown", WorldKind::downtown},
    {"indoor", WorldKind::indoor}};
constexpr std::initializer_list<std::pair<const char*, EgoKind>> kEgos{
    {"automatic", EgoKind::automatic},
    {"car", EgoKind::car},
    {"robot", EgoKind::robot},
    {"handheld", EgoKind::handheld}};

/** The enumerator of a word. \param kind what the word should name \throws UserError. */
template <typename Enum>
Enum enumeratorOf(const std::string& word,
                  std::initializer_list<std::pair<const char*, Enum>> names,
                  const std::string& kind)
{
  std::vector<std::string> words;
  for (const auto& [text, enumerator] : names)
  {
    if (word == text)
    {
      return enumerator;
    }
    words.emplace_back(text);
  }
  throw UserError(unknownWord(kind, word, words));
}
}  // namespace

void SimulatorOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("world", world, kWorlds, "kind of the simulated world");
  const std::string sensor_before = toString(sensor);
  std::string sensor_name = sensor_before;
  visitor.word("sensor", sensor_name, sensorNames(), "simulated LiDAR");
  if (sensor_name != sensor_before)
  {
    sensor = sensorKindFromString(sensor_name);
  }
  visitor.real("traffic", traffic, 0, 1, "traffic density, from 0 (nothing moves) to 1 (jam)");
  visitor.integer("seed", seed, 0, 2147483647, "seed of world, traffic and noise");
  visitor.integer(
      "traffic_seed", traffic_seed, -1, 2147483647,
      "seed of traffic, ego-motion and noise, if other than that of the world; -1: seed");
  visitor.choice("ego", ego, kEgos,
                 "carrier of the sensor; automatic: a robot on campus and indoors, else a car");
  visitor.real("ego_speed", ego_speed, 0, 40,
               "cruising speed of the ego; 0: the default of the world [m/s]");
  visitor.real("loop_length", loop_length, 50, 10000, "approximate length of the ego's loop [m]");
  visitor.real("start_time", start_time, 0, 600, "time simulated before the first scan [s]");
  visitor.real("start_fraction", start_fraction, 0, 1,
               "start of the ego on its loop, as a fraction of the loop");
  visitor.flag("reverse", reverse,
               "the ego drives its loop in the opposite direction; not on a highway");
  visitor.flag("stops", stops, "the ego stops at random times");
  visitor.degrees("mounting_roll_deg", mounting_roll, -180, 180,
                  "roll of the lidar on the ego [deg]");
  visitor.degrees("mounting_pitch_deg", mounting_pitch, -90, 90,
                  "pitch of the lidar on the ego; above 0 it looks downwards [deg]");
  visitor.flag("motion_distortion", motion_distortion,
               "points are measured while the sensor moves; false: all at the stamp");
  visitor.flag("noise", noise,
               "simulate range noise, lost returns and mixed pixels; false: exact ranges");
  visitor.integer("columns", columns, 0, 8192, "firings per revolution; 0: those of the sensor");
  visitor.real("max_range", max_range, 0, 300,
               "largest range of a return; 0: that of the sensor [m]");
  visitor.real("moving_speed", moving_speed, 0, 10,
               "speed above which bodies are labelled moving [m/s]");
  visitor.flag("imu", imu, "simulate an IMU: angular velocity and acceleration at 100 Hz");
  visitor.flag("wheels", wheels,
               "simulate wheel odometry: forward speed and yaw rate at 50 Hz; not hand-held");
}

WorldKind worldKindFromString(const std::string& name)
{
  return enumeratorOf(name, kWorlds, "world");
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

EgoKind egoKindFromString(const std::string& name)
{
  return enumeratorOf(name, kEgos, "carrier");
}
}  // namespace dyslam::sim
