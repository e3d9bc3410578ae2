// SPDX-License-Identifier: BSD-3-Clause
#include "TrajectoryCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>
#include <dyslam/eval/Axes.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/plot/TrajectoryPlot.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "MetricFlags.h"
#include "OutputFiles.h"
#include "PairNote.h"
#include "TimeRange.h"

namespace dyslam
{
namespace
{
constexpr double default_tolerance = 0.01;  // [s]

struct TrajectoryArguments
{
  std::vector<std::string> references;
  std::vector<std::string> estimates;
  MetricFlags metrics;
  std::optional<double> tolerance;  //!< of time stamps [s]
  std::optional<double> time_offset;
  std::string camera;
  std::string calib;
  std::string plot;
  std::string paper;
  bool statistics = false;
  bool per_length = false;
  OutputFlags output;
};

/** A file's poses; those of a camera are taken to the lidar. */
TrajectoryFile readPoses(const std::string& path, bool camera, const std::string& calib)
{
  TrajectoryFile file = readTrajectory(path);
  if (camera)
  {
    const Pose T_cam_velo = calib.empty() ? cameraAxes() : readKittiCalib(calib).T_cam_velo;
    std::vector<Pose> poses;
    for (const StampedPose& pose : file.trajectory)
    {
      poses.push_back(pose.pose);
    }
    poses = cameraToLidarPoses(poses, T_cam_velo);
    for (std::size_t i = 0; i < poses.size(); ++i)
    {
      file.trajectory[i].pose = poses[i];
    }
  }
  return file;
}

void warnAboutAxes(const std::string& reference,
                   const std::string& estimate,
                   const PosePairs& pairs)
{
  const BodyAxes axes = compareBodyAxes(pairs);
  if (axes == BodyAxes::differ)
  {
    std::cerr << "warning: " << estimate << " and " << reference
              << " move in different directions of their bodies: their axes differ; give both in "
                 "the same frame\n";
  }
  else if (axes != BodyAxes::same)
  {
    const bool is_estimate = axes == BodyAxes::estimate_camera;
    std::cerr << "warning: the poses of " << (is_estimate ? estimate : reference)
              << " have the axes of a camera (z ahead), those of "
              << (is_estimate ? reference : estimate)
              << " the axes of a lidar (x ahead); compare them with --camera "
              << (is_estimate ? "estimate" : "reference") << " (and --calib calib.txt)\n";
  }
}

/** \throws UserError if flags for time stamps are given with a file that has none. */
void requireNoTimeFlags(const TrajectoryArguments& a, const std::string& file)
{
  if (a.tolerance || a.time_offset)
  {
    throw UserError(file +
                    ": has no time stamps (KITTI), its poses are paired line by line; leave " +
                    (a.tolerance ? "--tolerance" : "--time-offset") + " out, or give a TUM file");
  }
}

/** Those whose position is finite. */
Trajectory finitePoses(const Trajectory& trajectory)
{
  Trajectory finite;
  for (const StampedPose& pose : trajectory)
  {
    if (pose.pose.translation().allFinite())
    {
      finite.push_back(pose.stamp, pose.pose);
    }
  }
  return finite;
}

PosePairs associate(const std::string& reference_path,
                    const std::string& estimate_path,
                    const TrajectoryArguments& a)
{
  const double tolerance = a.tolerance.value_or(default_tolerance);
  const TrajectoryFile reference = readPoses(reference_path, a.camera == "reference", a.calib);
  TrajectoryFile estimate = readPoses(estimate_path, a.camera == "estimate", a.calib);
  for (std::size_t i = 0; i < estimate.trajectory.size(); ++i)
  {
    estimate.trajectory[i].stamp += a.time_offset.value_or(0);
  }
  if (reference.trajectory.empty() || estimate.trajectory.empty())
  {
    throw UserError((reference.trajectory.empty() ? reference_path : estimate_path) +
                    ": has no poses");
  }
  if (reference.format == TrajectoryFormat::tum && estimate.format == TrajectoryFormat::tum)
  {
    if (estimate.trajectory.size() < 2)
    {
      throw UserError(estimate_path + ": has one pose; errors need two or more");
    }
    PosePairs pairs = associateByTime(reference.trajectory, estimate.trajectory, tolerance);
    if (pairs.size() < 2)
    {
      throw UserError(estimate_path + ": only " + std::to_string(pairs.size()) + " of " +
                      std::to_string(pairs.estimate_size) + " time stamps are within --tolerance " +
                      shortNumber(tolerance) + " s of one in " + reference_path + " (" +
                      timesOf(estimate.trajectory) + " and " + timesOf(reference.trajectory) +
                      "; --time-offset is added to the estimate's)");
    }
    noteFewPairs(pairs, estimate_path, reference_path, "--tolerance " + shortNumber(tolerance));
    return pairs;
  }
  requireNoTimeFlags(a,
                     reference.format == TrajectoryFormat::kitti ? reference_path : estimate_path);
  if (reference.trajectory.size() != estimate.trajectory.size())
  {
    std::cerr << "note: " << estimate_path << " has " << counted(estimate.trajectory.size(), "pose")
              << ", " << reference_path << " " << reference.trajectory.size()
              << "; without time stamps they are associated by index\n";
  }
  return associateByIndex(reference.trajectory, estimate.trajectory);
}

/** Mean over the estimates, for benchmarks of several sequences; the drift over those that are long
 * enough to have one. */
TrajectoryReport meanDrift(const std::vector<TrajectoryReport>& reports)
{
  TrajectoryReport mean;
  mean.name = "mean";
  const auto with_drift = static_cast<double>(
      std::count_if(reports.begin(), reports.end(),
                    [](const TrajectoryReport& r) { return r.drift.overall.segments > 0; }));
  for (const auto& r : reports)
  {
    mean.pairs += r.pairs;
    mean.length += r.length;
    if (r.drift.overall.segments > 0)
    {
      mean.drift.overall.segments += r.drift.overall.segments;
      mean.drift.overall.translation_percent += r.drift.overall.translation_percent / with_drift;
      mean.drift.overall.rotation_deg_per_100m +=
          r.drift.overall.rotation_deg_per_100m / with_drift;
    }
  }
  return mean;
}

void addMeanRow(Table& table, const std::vector<TrajectoryReport>& reports)
{
  const TrajectoryReport mean = meanDrift(reports);
  const SegmentDrift& drift = mean.drift.overall;
  const auto shown = [&](double value)
  { return drift.segments > 0 ? std::optional<double>(value) : std::nullopt; };
  std::vector<TableCell> cells{mean.name, TableCell(static_cast<double>(mean.pairs), 0),
                               TableCell(mean.length, 1),
                               TableCell(shown(drift.translation_percent), 4),
                               TableCell(shown(drift.rotation_deg_per_100m), 4)};
  while (cells.size() < table.columns())
  {
    cells.emplace_back("-");
  }
  table.addRow(std::move(cells));
}

/** Without a reference: how far the estimates travel, and where. */
void runPaths(const TrajectoryArguments& a)
{
  if (a.camera == "reference")
  {
    throw UserError("--camera reference: there is no --reference");
  }
  Table table({"trajectory", "poses", "duration [s]", "length [m]", "start to end [m]"});
  nlohmann::ordered_json json;
  json["trajectories"] = nlohmann::ordered_json::array();
  const std::vector<std::string> names = shortNames(a.estimates);
  std::vector<NamedPath> paths;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const TrajectoryFile file = readPoses(a.estimates[i], a.camera == "estimate", a.calib);
    const Trajectory trajectory = finitePoses(file.trajectory);
    if (trajectory.empty())
    {
      throw UserError(a.estimates[i] + ": has no poses");
    }
    const StampedPose& first = trajectory[0];
    const StampedPose& last = trajectory[trajectory.size() - 1];
    const auto duration = file.format == TrajectoryFormat::tum
                              ? std::optional<double>(last.stamp - first.stamp)
                              : std::nullopt;
    const double length = trajectory.pathLengths().back();
    const double apart = (last.pose.translation() - first.pose.translation()).norm();
    table.addRow({names[i], TableCell(static_cast<double>(trajectory.size()), 0),
                  TableCell(duration, 1), TableCell(length, 1), TableCell(apart, 3)});
    json["trajectories"].push_back(
        {{"name", names[i]},
         {"estimated_poses", trajectory.size()},
         {"duration_s", duration ? nlohmann::ordered_json(*duration) : nlohmann::ordered_json()},
         {"length_m", length},
         {"start_to_end_m", apart}});
    paths.push_back({names[i], {}});
    for (const StampedPose& pose : trajectory)
    {
      paths.back().poses.push_back(pose.pose);
    }
  }
  std::cerr << "note: no --reference: path lengths, but no errors\n";
  a.output.write(table, textOf(json));
  if (!a.plot.empty())
  {
    writePng(a.plot, renderPaths(paths));
  }
}

void runTrajectory(const TrajectoryArguments& a)
{
  if (!a.plot.empty() && std::filesystem::path(a.plot).extension() != ".png")
  {
    throw UserError("--plot " + a.plot + ": the ending must be .png");
  }
  if (!a.calib.empty() && a.camera.empty())
  {
    throw UserError("--calib goes with --camera, which says whose poses are the camera's");
  }
  if (a.references.empty())
  {
    runPaths(a);
    return;
  }
  if (!a.plot.empty() && a.references.size() > 1)
  {
    throw UserError("--plot draws estimates of one reference, but several were given");
  }
  if (a.references.size() != 1 && a.references.size() != a.estimates.size())
  {
    throw UserError("give one --reference, or as many as there are estimates (" +
                    std::to_string(a.references.size()) + " and " +
                    std::to_string(a.estimates.size()) + " given)");
  }
  const TrajectoryMetricsOptions metrics = a.metrics.options();
  const std::vector<std::string> names = shortNames(a.estimates);
  std::vector<TrajectoryReport> reports;
  std::vector<TrajectoryPlotItem> plots;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const std::string& reference = a.references[a.references.size() == 1 ? 0 : i];
    const PosePairs pairs = associate(reference, a.estimates[i], a);
    warnAboutAxes(reference, a.estimates[i], pairs);
    reports.push_back(evaluateTrajectory(a.estimates[i], pairs, metrics));
    reports.back().name = names[i];
    plots.push_back({names[i], pairs});
  }
  Table table = a.paper.empty() ? trajectoryTable(reports) : trajectoryTable(reports, a.paper);
  if (a.references.size() > 1)
  {
    addMeanRow(table, reports);
  }
  a.output.write(table, trajectoryJson(reports));
  if (a.statistics)
  {
    std::cout << '\n' << errorStatisticsTable(reports).toText();
  }
  if (a.per_length)
  {
    std::cout << '\n' << driftTable(reports).toText();
  }
  if (!a.plot.empty())
  {
    writePng(a.plot, renderTrajectoryPlot(plots, {"", metrics.alignment}));
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
                                           "true poses; one file, or one for each estimate; "
                                           "without, lengths and --plot only");
  sub->add_option("--estimate", a->estimates, "poses to evaluate; any number of files")->required();
  a->metrics.declare(*sub);
  sub->add_option("--tolerance", a->tolerance, "largest difference of time stamps (TUM) [s]")
      ->check(notNegative())
      ->default_str(shortNumber(default_tolerance));
  sub->add_option("--time-offset", a->time_offset,
                  "added to the time stamps of the estimates (TUM) [s]: for clocks that differ");
  sub->add_option("--camera", a->camera,
                  "which poses are a camera's (z ahead), to be taken to the lidar's: estimate or "
                  "reference")
      ->check(CLI::IsMember({"estimate", "reference"}));
  sub->add_option(
      "--calib", a->calib,
      "calib.txt with the camera's mounting, for --camera (default: only the axes turn)");
  sub->add_flag("--statistics", a->statistics, "also max, mean, median, min, RMSE and std");
  sub->add_flag("--per-length", a->per_length, "also t_rel and r_rel of each segment length");
  sub->add_option("--paper", a->paper,
                  "add the paper's results for a sequence: odometry/00-10, tracking/04, campus/01");
  addOutputFile(*sub, "--plot", a->plot, "plot the trajectories and their errors to this PNG file");
  for (const char* of_errors : {"--align", "--lengths", "--tolerance", "--time-offset",
                                "--statistics", "--per-length", "--paper"})
  {
    sub->get_option(of_errors)->needs(reference);
  }
  a->output.declare(*sub);
  return {sub, [a] { runTrajectory(*a); }};
}
}  // namespace dyslam
