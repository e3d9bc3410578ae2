// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Shard.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"
#include "Benchmark.h"
#include "Recorder.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

struct Arguments
{
  Recording recording;
  std::string world = "urban", sensor = "HDL64E", ego = "automatic";
  std::string benchmark, split, only, shard;
  int count = 0;
  std::optional<double> seconds;
  bool no_noise = false, no_distortion = false, no_stops = false, no_flow = false, force = false,
       quiet = false;
};

/** The flags of sets of recordings, after those of a single one. */
void declareSets(CLI::App& app, Arguments& a)
{
  CLI::Option* benchmark = app.add_option("--benchmark", a.benchmark,
                                          "write the fixed benchmark set to this folder instead");
  for (const char* fixed :
       {"--world",   "--sensor",     "--traffic",  "--seed",          "--traffic-seed",
        "--reverse", "--output",     "--ego",      "--speed",         "--loop",
        "--start",   "--start-time", "--one-loop", "--columns",       "--max-range",
        "--compact", "--no-flow",    "--no-noise", "--no-distortion", "--no-stops",
        "--count",   "--imu",        "--wheels"})
  {
    benchmark->excludes(app.get_option(fixed));
  }
  app.add_option("--split", a.split, "the eleven drives of validation or test as benchmark set")
      ->needs(benchmark);
  app.add_option("--only", a.only, "a single recording of the benchmark set")->needs(benchmark);
  app.add_option(
      "--shard", a.shard,
      "K/N: only the K-th of every N recordings of --benchmark or --count, for N machines");
}

void declare(CLI::App& app, Arguments& a)
{
  SimulatorOptions& o = a.recording.simulator;
  app.description(
      "Simulates a LiDAR in a dynamic environment; writes a rawlog and its ground truth");
  app.add_option("--world", a.world, "urban, campus, highway, tunnel or field (urban)");
  app.add_option("--sensor", a.sensor,
                 "HDL64E, HDL32E, VLP16, OS1-32, OS1-64, OS1-128, PANDAR64, XT32 or AVIA (HDL64E)");
  app.add_option("--traffic", o.traffic, "density, from 0 (nothing moves) to 1 (jam) (0.4)");
  app.add_option("--seconds", a.seconds,
                 "simulated time [s] (10); upper limit for the benchmark sets");
  app.add_option("--seed", o.seed, "seed of world, traffic and noise (1)");
  app.add_option("--traffic-seed", o.traffic_seed,
                 "seed of traffic, the ego's motion and noise, in the world of --seed: another "
                 "recording of the same place (--seed)");
  app.add_option("-o,--output", a.recording.output, "rawlog to write; with --count a folder");
  app.add_option(
         "--count", a.count,
         "number of recordings, with the seeds from --seed (--traffic-seed) on, named by world, "
         "sensor and seed")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--ego", a.ego,
                 "carrier of the sensor: car, robot or handheld (default of the world)");
  app.add_option("--speed", o.ego_speed, "cruising speed [m/s]; 0: default of the world (0)");
  app.add_option("--loop", o.loop_length, "approximate length of the closed loop [m] (400)");
  app.add_option("--start", o.start_fraction, "start of the ego on the loop, 0 to 1 (0)");
  app.add_flag("--reverse", o.reverse,
               "drive the loop in the opposite direction; not on a highway or in a tunnel");
  app.add_option("--start-time", o.start_time, "traffic simulated before the first scan [s] (5)");
  app.add_flag("--one-loop", a.recording.one_loop,
               "stop when the loop is closed, or after --seconds");
  app.add_option("--columns", o.columns, "firings per revolution; 0: the sensor's (0)");
  app.add_option("--max-range", o.max_range, "[m] (the sensor's)");
  app.add_flag("--compact", a.recording.compact,
               "small files: coordinates in multiples of 1/128 m, points sorted by ring");
  app.add_flag("--no-flow", a.no_flow, "do not write the per-point scene flow");
  app.add_flag("--no-noise", a.no_noise, "exact ranges without losses");
  app.add_flag("--no-distortion", a.no_distortion,
               "all points of a scan are measured at its stamp");
  app.add_flag("--no-stops", a.no_stops, "the ego stops for other road users only");
  app.add_flag("--imu", o.imu, "also an IMU: angular velocity and acceleration at 100 Hz");
  app.add_flag(
      "--wheels", o.wheels,
      "also wheel odometry: forward speed and yaw rate at 50 Hz; not with a hand-held ego");
  app.add_option("--threads", a.recording.threads, "0: number of cores (0)")
      ->check(CLI::Range(0, 256));
  declareSets(app, a);
  app.add_flag("--force", a.force, "replace earlier recordings and their ground truth");
  app.add_flag("-q,--quiet", a.quiet, "no progress");
}

EgoKind egoKind(const std::string& name)
{
  const std::vector<std::pair<std::string, EgoKind>> kinds{{"automatic", EgoKind::automatic},
                                                           {"car", EgoKind::car},
                                                           {"robot", EgoKind::robot},
                                                           {"handheld", EgoKind::handheld}};
  for (const auto& [word, kind] : kinds)
  {
    if (word == name)
    {
      return kind;
    }
  }
  throw UserError("--ego: '" + name + "' is none of car, robot, handheld");
}

void recordOne(const Recording& recording, bool force, bool quiet)
{
  requireNewRecording(recording.output, force);
  const auto folder = std::filesystem::path(recording.output).parent_path();
  if (!folder.empty())
  {
    makeFolder(folder.string(), "choose another --output");
  }
  RecordingResult result;
  {
    Progress progress("dyslam-sim", "scans", quiet);
    result = record(recording,
                    [&](double fraction, std::size_t scans) { progress.update(fraction, scans); });
    progress.finish(result.scans);
  }
  std::printf(
      "%s: %s, %zu points (%.1f %% moving), %s observed, %.1f m travelled, loop %.1f m; ground "
      "truth in %s\n",
      recording.output.c_str(), counted(result.scans, "scan").c_str(), result.points,
      100.0 * static_cast<double>(result.moving_points) /
          static_cast<double>(std::max<std::size_t>(1, result.points)),
      counted(result.objects, "object").c_str(), result.distance, result.loop_length,
      result.ground_truth.c_str());
}

/** Those of the requested shard. */
std::vector<NamedRecording> partOf(const Arguments& a, const std::vector<NamedRecording>& all)
{
  return a.shard.empty() ? all : Shard::fromText(a.shard).of(all);
}

/** --count recordings of consecutive seeds, of the traffic where that has its own; each depends on
 * its seeds alone. */
std::vector<NamedRecording> seriesOf(const Arguments& a)
{
  std::vector<NamedRecording> series;
  for (int i = 0; i < a.count; ++i)
  {
    NamedRecording one;
    one.recording = a.recording;
    SimulatorOptions& o = one.recording.simulator;
    const bool same_world = o.traffic_seed >= 0;
    (same_world ? o.traffic_seed : o.seed) += i;
    one.name = a.world + "_" + a.sensor + "_" + std::to_string(o.seed) +
               (same_world ? "_" + std::to_string(o.traffic_seed) : "");
    one.recording.output = a.recording.output + "/" + one.name + ".rawlog";
    series.push_back(one);
  }
  return series;
}

/** The set of --benchmark, or the one recording of --only. */
std::vector<NamedRecording> benchmarkOf(const Arguments& a)
{
  const std::vector<NamedRecording> set =
      a.split.empty() ? standingSet(a.benchmark) : splitSet(a.benchmark, a.split);
  return a.only.empty() ? set : std::vector<NamedRecording>{oneOf(set, a.only)};
}

void run(Arguments& a)
{
  if (!(a.seconds.value_or(1) > 0))
  {
    throw UserError("--seconds: must be above 0");
  }
  if (!a.benchmark.empty())
  {
    dyslam::makeFolder(a.benchmark);
    for (auto& named : partOf(a, benchmarkOf(a)))
    {
      named.recording.threads = a.recording.threads;
      named.recording.seconds =
          std::min(named.recording.seconds, a.seconds.value_or(named.recording.seconds));
      named.recording.least_distance = a.seconds ? 0 : named.recording.least_distance;
      recordOne(named.recording, a.force, a.quiet);
    }
    return;
  }
  if (a.recording.output.empty())
  {
    throw UserError("give the output with -o x.rawlog, or --benchmark DIR");
  }
  if (!a.shard.empty() && a.count == 0)
  {
    throw UserError("--shard requires --count or --benchmark");
  }
  a.recording.seconds = a.seconds.value_or(a.recording.seconds);
  SimulatorOptions& o = a.recording.simulator;
  o.world = worldKindFromString(a.world);
  o.sensor = sensorKindFromString(a.sensor);
  o.ego = egoKind(a.ego);
  o.noise = !a.no_noise;
  o.motion_distortion = !a.no_distortion;
  o.stops = !a.no_stops;
  a.recording.flow = !a.no_flow;
  a.recording.compression_level = a.recording.compact ? 9 : 1;
  if (a.count == 0)
  {
    recordOne(a.recording, a.force, a.quiet);
    return;
  }
  dyslam::makeFolder(a.recording.output);
  for (const NamedRecording& named : partOf(a, seriesOf(a)))
  {
    recordOne(named.recording, a.force, a.quiet);
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
