// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GroundTruth.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"
#include "../common/Shard.h"
#include "../common/StopSignals.h"
#include "Arguments.h"
#include "Benchmark.h"
#include "Recorder.h"
#include "Series.h"

namespace
{
using namespace dyslam;
using namespace dyslam::sim;

/** Simulates one recording and prints a line about it. \throws UserError. */
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
                    [&](double fraction, std::size_t scans)
                    {
                      progress.update(fraction, scans);
                      if (stop_asked)
                      {
                        throw UserError("stopped after " + counted(scans, "scan") + "; " +
                                        recording.output + " was not written");
                      }
                    });
    progress.finish(result.scans);
  }
  std::printf(
      "%s: %s, %s (%.1f %% moving), %s observed, %.1f m travelled, loop %.1f m; ground "
      "truth in %s\n",
      recording.output.c_str(), counted(result.scans, "scan").c_str(),
      counted(result.points, "point").c_str(),
      100.0 * static_cast<double>(result.moving_points) /
          static_cast<double>(std::max<std::size_t>(1, result.points)),
      counted(result.objects, "object").c_str(), result.distance, result.loop_length,
      result.ground_truth.c_str());
}

/** Simulates one recording of several, unless it is there already. \throws UserError. */
void recordOneOfMany(const Recording& recording, bool force, bool quiet)
{
  if (!force && std::filesystem::is_regular_file(recording.output) &&
      std::filesystem::is_directory(groundTruthFolder(recording.output)))
  {
    std::printf("%s: there already\n", recording.output.c_str());
    return;
  }
  recordOne(recording, force, quiet);
}

/** The recordings of the requested shard. */
std::vector<NamedRecording> partOf(const Arguments& a, const std::vector<NamedRecording>& all)
{
  return a.shard.empty() ? all : Shard::fromText(a.shard).of(all);
}

/** The set of --benchmark, or the one recording of --only. */
std::vector<NamedRecording> benchmarkOf(const Arguments& a)
{
  const std::vector<NamedRecording> set =
      a.split.empty() ? standingSet(a.benchmark) : splitSet(a.benchmark, a.split);
  return a.only.empty() ? set : std::vector<NamedRecording>{oneOf(set, a.only)};
}

void recordBenchmark(const Arguments& a)
{
  makeFolder(a.benchmark);
  for (NamedRecording& named : partOf(a, benchmarkOf(a)))
  {
    Recording& recording = named.recording;
    recording.threads = a.recording.threads;
    recording.seconds = std::min(recording.seconds, a.seconds.value_or(recording.seconds));
    recording.least_distance = a.seconds ? 0 : recording.least_distance;
    recordOneOfMany(recording, a.force, a.quiet);
  }
}

void run(const Arguments& a)
{
  stopOnSignals();
  if (!(a.seconds.value_or(1) > 0))
  {
    throw UserError("--seconds: must be above 0");
  }
  if (!a.benchmark.empty())
  {
    recordBenchmark(a);
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
  const Recording recording = recordingOf(a);
  if (a.count == 0)
  {
    recordOne(recording, a.force, a.quiet);
    return;
  }
  makeFolder(recording.output);
  for (const NamedRecording& named : partOf(a, seriesOf(a, recording)))
  {
    recordOneOfMany(named.recording, a.force, a.quiet);
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
