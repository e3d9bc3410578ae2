// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/io/Conversion.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "../common/OutputOptions.h"

namespace dyslam::sim
{
namespace
{
// The ranges are those of SimulatorOptions, whose errors name its keys instead of the flags.

void declareWorld(CLI::App& app, Arguments& a)
{
  SimulatorOptions& o = a.recording.simulator;
  const CLI::Validator seeds = CLI::Range(0, std::numeric_limits<int>::max());
  app.add_option("--world", a.world,
                 "urban, downtown, campus, highway, tunnel, field or indoor (urban)");
  app.add_option("--sensor", a.sensor,
                 "HDL64E, HDL32E, VLP16, VLP32C, VLS128, OS1-32, OS1-64, OS1-128, PANDAR64, XT32 "
                 "or AVIA (HDL64E)");
  app.add_option("--traffic", o.traffic, "density, from 0 (nothing moves) to 1 (jam) (0.4)")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--seconds", a.seconds,
                 "simulated time [s] (10); upper limit for the benchmark sets");
  app.add_option("--seed", o.seed, "seed of world, traffic and noise (1)")->check(seeds);
  app.add_option("--traffic-seed", o.traffic_seed,
                 "seed of traffic, the ego's motion and noise, in the world of --seed: another "
                 "recording of the same place (--seed)")
      ->check(seeds);
  addOutputFile(app, "-o,--output", a.recording.output, "rawlog to write; with --count a folder");
  app.add_option(
         "--count", a.count,
         "number of recordings, with the seeds from --seed (--traffic-seed) on, named by world, "
         "sensor and seed")
      ->check(CLI::Range(1, 1000000));
}

void declareEgo(CLI::App& app, Arguments& a)
{
  SimulatorOptions& o = a.recording.simulator;
  app.add_option("--ego", a.ego,
                 "carrier of the sensor: car, robot or handheld (default of the world)");
  app.add_option("--speed", o.ego_speed, "cruising speed [m/s]; 0: default of the world (0)")
      ->check(CLI::Range(0.0, 40.0));
  app.add_option("--loop", o.loop_length,
                 "approximate length of the closed loop [m]; indoors 150 to 600 (400)")
      ->check(CLI::Range(50.0, 10000.0));
  app.add_option("--start", o.start_fraction, "start of the ego on the loop, 0 to 1 (0)")
      ->check(CLI::Range(0.0, 1.0));
  app.add_flag("--reverse", o.reverse,
               "drive the loop in the opposite direction; not on a highway or in a tunnel");
  app.add_option("--start-time", o.start_time, "traffic simulated before the first scan [s] (5)")
      ->check(CLI::Range(0.0, 600.0));
  app.add_flag("--one-loop", a.recording.one_loop,
               "stop when the loop is closed, or after --seconds");
}

void declareLidar(CLI::App& app, Arguments& a)
{
  SimulatorOptions& o = a.recording.simulator;
  app.add_option("--columns", o.columns, "firings per revolution; 0: the sensor's (0)")
      ->check(CLI::Range(0, 8192));
  app.add_option("--max-range", o.max_range, "[m]; 0: the sensor's (0)")
      ->check(CLI::Range(0.0, 300.0));
  app.add_option("--mounting", a.mounting_deg, "roll and pitch of the lidar on the ego [deg] (0 0)")
      ->expected(2);
  app.add_option("--further-sensor", a.further_sensors,
                 "another lidar on the ego and its pose there: x y z [m] yaw pitch roll [deg] in "
                 "quotes; repeatable. dyslam merges its scans with input.further_lidars")
      ->type_name("SENSOR POSE");
}

/** What is in the recording. */
void declareContents(CLI::App& app, Arguments& a)
{
  app.add_flag("--compact", a.recording.compact,
               "small files: coordinates in multiples of 1/128 m, points sorted by ring");
  app.add_flag("--no-flow", a.no_flow, "do not write the per-point scene flow");
  app.add_flag("--no-noise", a.no_noise, "exact ranges without losses, exact IMU and wheels");
  app.add_flag("--no-distortion", a.no_distortion,
               "all points of a scan are measured at its stamp");
  app.add_flag("--no-stops", a.no_stops, "the ego stops for other road users only");
  app.add_flag("--imu", a.recording.simulator.imu,
               "also an IMU: angular velocity and acceleration at 100 Hz");
  app.add_flag(
      "--wheels", a.recording.simulator.wheels,
      "also wheel odometry: forward speed and yaw rate at 50 Hz; not with a hand-held ego");
  app.add_flag(
      "--gnss", a.recording.gnss,
      "also a satellite receiver: a position each second, 1.1 m off in east and in north, 2.2 m in "
      "height (RMS)");
}

/** The flags of sets of recordings, after those of a single one. */
void declareSets(CLI::App& app, Arguments& a)
{
  CLI::Option* benchmark = addOutputFolder(app, "--benchmark", a.benchmark,
                                           "write the fixed benchmark set to this folder instead");
  for (const char* fixed :
       {"--world",         "--sensor",     "--traffic",  "--seed",          "--traffic-seed",
        "--reverse",       "--output",     "--ego",      "--speed",         "--loop",
        "--start",         "--start-time", "--one-loop", "--columns",       "--max-range",
        "--compact",       "--no-flow",    "--no-noise", "--no-distortion", "--no-stops",
        "--count",         "--imu",        "--wheels",   "--gnss",          "--mounting",
        "--further-sensor"})
  {
    benchmark->excludes(app.get_option(fixed));
  }
  app.add_option("--split", a.split, "the eleven drives of validation or test as benchmark set")
      ->needs(benchmark);
  CLI::Option* only =
      app.add_option("--only", a.only, "a single recording of the benchmark set")->needs(benchmark);
  app.add_option(
         "--shard", a.shard,
         "K/N: only the K-th of every N recordings of --benchmark or --count, for N machines")
      ->excludes(only);
}

/** \param deg roll and pitch; empty: upright \throws UserError. */
void setMounting(const std::vector<double>& deg, SimulatorOptions& options)
{
  if (deg.empty())
  {
    return;
  }
  if (std::abs(deg[0]) > 180 || std::abs(deg[1]) > 90)
  {
    throw UserError("--mounting: give a roll from -180 to 180 and a pitch from -90 to 90 [deg]");
  }
  options.mounting_roll = deg[0] * radians_per_degree;
  options.mounting_pitch = deg[1] * radians_per_degree;
}
}  // namespace

void declare(CLI::App& app, Arguments& a)
{
  app.description(
      "Simulates a LiDAR in a dynamic environment; writes a rawlog and its ground truth");
  declareWorld(app, a);
  declareEgo(app, a);
  declareLidar(app, a);
  declareContents(app, a);
  app.add_option("--threads", a.recording.threads, "0: number of cores (0)")
      ->check(CLI::Range(0, 256));
  declareSets(app, a);
  app.add_flag("--force", a.force, "replace earlier recordings and their ground truth");
  app.add_flag("-q,--quiet", a.quiet, "no progress");
}

Recording recordingOf(const Arguments& a)
{
  Recording recording = a.recording;
  recording.seconds = a.seconds.value_or(recording.seconds);
  recording.flow = !a.no_flow;
  recording.compression_level = recording.compact ? 9 : 1;
  SimulatorOptions& o = recording.simulator;
  o.world = worldKindFromString(a.world);
  o.sensor = sensorKindFromString(a.sensor);
  o.ego = egoKindFromString(a.ego);
  setMounting(a.mounting_deg, o);
  for (const auto& [sensor, mounting] : a.further_sensors)
  {
    o.further_sensors.push_back(
        {sensorKindFromString(sensor), poseFromOption("--further-sensor", mounting)});
  }
  o.noise = !a.no_noise;
  o.motion_distortion = !a.no_distortion;
  o.stops = !a.no_stops;
  return recording;
}
}  // namespace dyslam::sim
