// SPDX-License-Identifier: BSD-3-Clause
#include "TrajectoryCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/TrajectoryComparison.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <dyslam/plot/TrajectoryPlot.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "MetricFlags.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct TrajectoryArguments
{
  std::vector<std::string> references;
  std::vector<std::string> estimates;
  MetricFlags metrics;
  PoseReading reading;  //!< without what there may be of each estimate:
  std::vector<double> time_offsets;
  std::vector<std::string> cameras;
  std::vector<std::string> calibs;
  std::vector<std::string> reference_bodies;
  std::string plot;
  std::string paper;
  bool statistics = false;
  bool per_length = false;
  OutputFlags output;
};

bool haveSegments(const std::vector<TrajectoryReport>& reports)
{
  return std::any_of(reports.begin(), reports.end(),
                     [](const TrajectoryReport& r) { return r.drift.overall.segments > 0; });
}

/** Says why the table lacks figures, if it does. */
void noteMissingFigures(const std::vector<TrajectoryReport>& reports,
                        const std::vector<double>& lengths)
{
  const auto ofPositions = [](const TrajectoryReport& r) { return r.positions_only; };
  if (std::any_of(reports.begin(), reports.end(), ofPositions))
  {
    printNote(
        "a reference of positions alone shows ATE [m]; the other errors need true orientations");
  }
  if (!haveSegments(reports) && !std::all_of(reports.begin(), reports.end(), ofPositions))
  {
    const std::string shortest =
        CLI::detail::to_string(*std::min_element(lengths.begin(), lengths.end()));
    printNote("no t_rel and r_rel: no segment of " + shortest +
              " m fits into the reference; --lengths gives shorter ones");
  }
}

/** How an estimate and its reference are read. */
PoseReading readingOf(const TrajectoryArguments& a, std::size_t estimate)
{
  PoseReading reading = a.reading;
  if (!a.time_offsets.empty())
  {
    reading.time_offset = oneOrEach(a.time_offsets, estimate);
  }
  const auto set = [estimate](std::string& value, const std::vector<std::string>& given)
  { value = given.empty() ? value : oneOrEach(given, estimate); };
  set(reading.camera, a.cameras);
  set(reading.calib, a.calibs);
  set(reading.reference_body, a.reference_bodies);
  return reading;
}

/** \throws UserError for flags of which there is not one value, or one for each estimate. */
void requireOneOfEach(const TrajectoryArguments& a)
{
  const auto require = [&a](const char* flag, std::size_t values)
  {
    if (values > 0)
    {
      requireOneOrEach(flag, values, a.estimates.size(), "estimates");
    }
  };
  require("--time-offset", a.time_offsets.size());
  require("--camera", a.cameras.size());
  require("--calib", a.calibs.size());
  require("--reference-body", a.reference_bodies.size());
}

/** Without a reference: how far the estimates travel, and where. */
void runPaths(const TrajectoryArguments& a)
{
  if (std::count(a.cameras.begin(), a.cameras.end(), "reference") > 0)
  {
    throw UserError("--camera reference: there is no --reference");
  }
  if (!a.calibs.empty() && a.cameras.empty())
  {
    throw UserError("--calib goes with --camera estimate where there is no --reference");
  }
  const std::vector<std::string> names = shortNames(a.estimates);
  std::vector<PathSummary> paths;
  std::vector<NamedPath> drawn;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    paths.push_back(readPath(a.estimates[i], readingOf(a, i), printNote));
    paths.back().name = names[i];
    drawn.push_back({names[i], {}});
    for (const StampedPose& pose : paths.back().trajectory)
    {
      drawn.back().poses.push_back(pose.pose);
    }
  }
  printNote("no --reference: path lengths, but no errors");
  a.output.write(pathTable(paths), pathJson(paths));
  if (!a.plot.empty())
  {
    writePng(a.plot, renderPaths(drawn));
  }
}

/** \throws UserError for references that do not go with the estimates or with other flags. */
void requireMatching(const TrajectoryArguments& a)
{
  if (!a.plot.empty() && a.references.size() > 1)
  {
    throw UserError("--plot draws estimates of one reference, but several were given");
  }
  if (!a.reading.reference_times.empty() && a.references.size() > 1)
  {
    throw UserError("--reference-times has the times of one reference, but several were given");
  }
  if (a.references.size() != 1 && a.references.size() != a.estimates.size())
  {
    throw UserError("give one --reference, or as many as there are estimates (" +
                    std::to_string(a.references.size()) + " and " +
                    std::to_string(a.estimates.size()) + " given)");
  }
}

/** Errors of the estimates, and what a plot of them shows. */
struct Compared
{
  std::vector<TrajectoryReport> reports;
  std::vector<TrajectoryPlotItem> plots;
};

/** Compares each estimate with its reference; prints warnings and notes. */
Compared compare(const TrajectoryArguments& a, const TrajectoryMetricsOptions& metrics)
{
  const std::vector<std::string> names = shortNames(a.estimates);
  Compared result;
  std::set<std::string> notes;  // those of a reference are the same for each estimate
  const auto note = [&notes](const std::string& text)
  {
    if (notes.insert(text).second)
    {
      printNote(text);
    }
  };
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const std::string& reference = a.references[a.references.size() == 1 ? 0 : i];
    const PoseReading reading = readingOf(a, i);
    const PosePairs pairs = pairFiles(reference, a.estimates[i], reading, note);
    TrajectoryReport report = evaluateTrajectory(a.estimates[i], pairs, metrics);
    const std::string warning = pairWarning(reference, a.estimates[i], reading, pairs, report);
    if (!warning.empty())
    {
      std::cerr << "warning: " << warning << '\n';
    }
    report.name = names[i];
    result.reports.push_back(std::move(report));
    result.plots.push_back({names[i], pairs});
  }
  return result;
}

void runTrajectory(const TrajectoryArguments& a)
{
  if (!a.plot.empty() && std::filesystem::path(a.plot).extension() != ".png")
  {
    throw UserError("--plot " + a.plot + ": the ending must be .png");
  }
  requireOneOfEach(a);
  if (a.references.empty())
  {
    runPaths(a);
    return;
  }
  requireMatching(a);
  const TrajectoryMetricsOptions metrics = a.metrics.options();
  const auto [reports, plots] = compare(a, metrics);
  Table table = a.paper.empty() ? trajectoryTable(reports) : trajectoryTable(reports, a.paper);
  const std::string no_mean =
      a.references.size() > 1 ? addMeanRows(table, reports, a.estimates, a.references) : "";
  a.output.write(table, trajectoryJson(reports));
  if (a.statistics)
  {
    std::cout << '\n' << errorStatisticsTable(reports).toText();
  }
  if (a.per_length && haveSegments(reports))
  {
    std::cout << '\n' << driftTable(reports).toText();
  }
  if (!a.plot.empty())
  {
    writePng(a.plot, renderTrajectoryPlot(plots, {"", metrics.alignment, ""}));
  }
  if (!no_mean.empty())
  {
    printNote(no_mean);
  }
  noteMissingFigures(reports, metrics.lengths);
  for (const std::string& note : comparisonNotes(reports, a.references.size() == 1))
  {
    printNote(note);
  }
}
}  // namespace

Subcommand trajectoryCommand(CLI::App& app)
{
  const auto a = std::make_shared<TrajectoryArguments>();
  CLI::App* sub = app.add_subcommand("trajectory",
                                     "Errors of trajectories (TUM or KITTI files) against a "
                                     "reference; without one, their lengths");
  CLI::Option* reference = sub->add_option("--reference", a->references,
                                           "true poses, or positions alone (t x y z, columns that "
                                           "a header names, RTKLIB's .pos); one file, or one for "
                                           "each estimate; without, lengths and --plot only");
  sub->add_option("--estimate", a->estimates, "poses to evaluate; any number of files")->required();
  a->metrics.declare(*sub);
  CLI::Option* tolerance =
      sub->add_option("--tolerance", a->reading.tolerance,
                      "largest difference of time stamps (TUM) [s]")
          ->check(notNegative())
          ->default_str(CLI::detail::to_string(PoseReading::default_tolerance));
  sub->add_option("--interpolate", a->reading.interpolate,
                  "interpolate the reference at the time stamps of the estimates (TUM), between "
                  "poses at most this far from them [s], instead of the nearest within --tolerance")
      ->check(positive())
      ->excludes(tolerance);
  sub->add_option("--time-offset", a->time_offsets,
                  "added to the time stamps of the estimates (TUM) [s]: for clocks that differ; of "
                  "all estimates, or one for each");
  sub->add_option("--camera", a->cameras,
                  "which poses are a camera's (z ahead), to be taken to the lidar's: estimate, "
                  "reference or none; of all estimates, or one for each (default: where one of the "
                  "two moves as a camera and the other as a lidar, the one that does)")
      ->check(CLI::IsMember({"estimate", "reference", "none"}));
  sub->add_option("--calib", a->calibs,
                  "calib.txt with the camera's mounting, of all estimates, or one for each "
                  "(default: that of the sequence, which is looked for in sequences/NN of "
                  "poses/NN.txt and beside the poses; else only the axes turn)");
  sub->add_option(
      "--reference-body", a->reference_bodies,
      "pose of the reference's body (IMU, antenna) on that of the estimates: 'x y z yaw "
      "pitch roll' [m, deg], 'x y z 0 0 0' of an antenna or prism with positions alone; of all "
      "estimates, or one for each (default: both are poses of the same body)");
  sub->add_option("--reference-times", a->reading.reference_times,
                  "file with a time [s] for each line of a KITTI reference, which is then paired "
                  "by time");
  sub->add_flag("--statistics", a->statistics, "also max, mean, median, min, RMSE and std");
  sub->add_flag("--per-length", a->per_length, "also t_rel and r_rel of each segment length");
  sub->add_option("--paper", a->paper,
                  "add the paper's results for a sequence: odometry/00-10, tracking/04, campus/01");
  addOutputFile(*sub, "--plot", a->plot, "plot the trajectories and their errors to this PNG file");
  for (const char* of_errors :
       {"--align", "--lengths", "--tolerance", "--interpolate", "--time-offset", "--reference-body",
        "--reference-times", "--statistics", "--per-length", "--paper"})
  {
    sub->get_option(of_errors)->needs(reference);
  }
  a->output.declare(*sub);
  return {sub, [a] { runTrajectory(*a); }};
}
}  // namespace dyslam
