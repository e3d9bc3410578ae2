// SPDX-License-Identifier: BSD-3-Clause
#include "RunCommand.h"

#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Printable.h>
#include <dyslam/eval/Consistency.h>
#include <dyslam/eval/TrajectoryReports.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "LabelFolders.h"
#include "MetricFlags.h"
#include "OutputFiles.h"
#include "RunReport.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments
{
  std::vector<std::string> folders;
  std::string truth;
  MetricFlags metrics;
  OutputFlags output;
};

/** Results of one run and its ground truth. */
struct RunScores
{
  std::string name;
  Json report;
  std::optional<TrajectoryReport> trajectory;
  std::optional<TrajectoryReport> odometry;
  std::optional<OdometryConsistency> consistency;
  std::optional<LabelComparison> labels;
};

constexpr double tolerance = 1e-3;  // all files of a run contain the scans' stamps [s]

Json readReport(const fs::path& folder)
{
  const auto report = readRunReport(folder.string());
  if (!report)
  {
    std::cerr << "note: " << folder.string() << " has no report.json: the run did not finish\n";
  }
  else if (const auto missing = report->find("not_written");
           missing != report->end() && missing->is_array())
  {
    for (const Json& reason : *missing)
    {
      std::cerr << "note: the run lacks a file: "
                << (reason.is_string() ? printable(reason.get<std::string>()) : "") << '\n';
    }
  }
  return report.value_or(Json::object());
}

/** Of so many scans of a recording those that the run's settings take. */
std::size_t scansTaken(const fs::path& folder, std::size_t recorded)
{
  RawlogSourceOptions input;
  if (const fs::path ini = folder / "effective.ini"; fs::exists(ini))
  {
    load(input, Config::fromFile(ini.string()), "input");
  }
  const auto first = static_cast<std::size_t>(input.skip_first_n);
  const auto most = static_cast<std::size_t>(input.only_first_n);
  const std::size_t rest = recorded - std::min(recorded, first);
  return most > 0 ? std::min(rest, most) : rest;
}

/** Says of a run that was killed how far it had come. \return whether it is one */
bool noteUnfinished(const std::string& folder, const Json& report, const std::string& truth)
{
  const auto finished = report.find("finished");
  if (finished == report.end() || !finished->is_boolean() || finished->get<bool>())
  {
    return false;
  }
  const auto frames = report.find("frames");
  std::string scans =
      frames != report.end() && frames->is_number() ? std::to_string(frames->get<long>()) : "?";
  const fs::path poses = fs::path(truth) / "poses_tum.txt";
  if (!truth.empty() && fs::exists(poses))
  {
    scans += " of " + std::to_string(scansTaken(folder, readTum(poses.string()).size()));
  }
  std::cerr << "note: " << folder << ": unfinished: " << scans << " scans; dyslam --resume -o "
            << folder << " goes on\n";
  return true;
}

/** True poses: the run's own, else those of the ground-truth folder; may not be there. */
fs::path referenceOf(const fs::path& folder, const std::string& truth)
{
  const fs::path own = folder / "reference_tum.txt";
  return fs::exists(own) || truth.empty() ? own : fs::path(truth) / "poses_tum.txt";
}

/** Nothing, with a note, if the run has no or too little ground truth. */
std::optional<TrajectoryReport> evaluate(const fs::path& folder,
                                         const char* file,
                                         const fs::path& reference,
                                         const TrajectoryMetricsOptions& metrics)
{
  const fs::path estimate = folder / file;
  if (!fs::exists(reference) || !fs::exists(estimate))
  {
    return std::nullopt;
  }
  const PosePairs pairs =
      associateByTime(readTum(reference.string()), readTum(estimate.string()), tolerance);
  if (pairs.size() < 2)
  {
    std::cerr
        << "note: " << estimate.string() << ": " << pairs.size() << " of " << pairs.estimate_size
        << " poses match a time stamp of the ground truth, 2 are needed: no errors computed\n";
    return std::nullopt;
  }
  return evaluateTrajectory(estimate.string(), pairs, metrics);
}

/** Nothing if the run does not state its covariances. */
std::optional<OdometryConsistency> evaluateConsistency(const fs::path& folder,
                                                       const fs::path& reference)
{
  const fs::path motions = folder / "motions.csv";
  const fs::path odometry = folder / "odometry_tum.txt";
  if (!fs::exists(motions) || !fs::exists(odometry))
  {
    return std::nullopt;
  }
  const PosePairs pairs =
      associateByTime(readTum(reference.string()), readTum(odometry.string()), tolerance);
  return odometryConsistency(pairs, readMotionFile(motions.string()), tolerance);
}

/** Ground-truth folder: as given, or next to the rawlog named in the report. */
std::string truthFolder(const Arguments& a, const Json& report)
{
  if (!a.truth.empty())
  {
    return a.truth;
  }
  const auto input = report.find("input");
  if (input == report.end() || !input->is_string())
  {
    return "";
  }
  return groundTruthFolder(input->get<std::string>());
}

RunScores scoresOf(const std::string& folder, const Arguments& a)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": is not a folder");
  }
  if (!fs::exists(fs::path(folder) / "trajectory_tum.txt"))
  {
    throw UserError(folder +
                    (fs::exists(fs::path(folder) / "odometry_tum.txt.tmp")
                         ? ": unfinished, without a checkpoint: has no trajectory_tum.txt"
                         : ": has no trajectory_tum.txt: is it the output folder of a run?"));
  }
  RunScores scores;
  scores.report = readReport(folder);
  const std::string truth = truthFolder(a, scores.report);
  const fs::path reference = referenceOf(folder, a.truth);
  scores.trajectory = evaluate(folder, "trajectory_tum.txt", reference, a.metrics.options());
  if (scores.trajectory)
  {
    scores.odometry = evaluate(folder, "odometry_tum.txt", reference, a.metrics.options());
    scores.consistency = evaluateConsistency(folder, reference);
  }
  else if (!fs::exists(reference))
  {
    std::cerr << "note: " << folder << " has no reference_tum.txt"
              << (a.truth.empty() ? ": its recording has no ground truth"
                                  : ", " + a.truth + " no poses_tum.txt: no errors computed")
              << '\n';
  }
  const bool unfinished = noteUnfinished(folder, scores.report, truth);
  const fs::path labels = fs::path(folder) / "labels";
  if (fs::is_directory(labels) && !(unfinished && fs::is_empty(labels)))
  {
    if (!truth.empty() && fs::is_directory(fs::path(truth) / "labels"))
    {
      scores.labels = compareLabelFolders(truth, folder);
    }
    else
    {
      std::cerr << "note: " << folder << ": labels not evaluated: "
                << (truth.empty() ? "no ground truth known (--truth)" : truth + " has no labels/")
                << '\n';
    }
  }
  return scores;
}

std::optional<double> number(const Json& json, const char* key)
{
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? std::optional<double>(it->get<double>())
                                             : std::nullopt;
}

void addRow(Table& table,
            const RunScores& run,
            const std::string& part,
            const std::optional<TrajectoryReport>& trajectory,
            bool whole)
{
  std::vector<TableCell> cells{run.name, part,
                               TableCell(whole ? number(run.report, "frames") : std::nullopt, 0)};
  const auto figure = [&](auto value, int digits)
  { cells.emplace_back(trajectory ? value(*trajectory) : std::optional<double>(), digits); };
  using Report = const TrajectoryReport&;
  using Value = std::optional<double>;
  figure([](Report r) -> Value { return r.length; }, 1);
  const auto drift = [](Report r, double v)
  { return r.drift.overall.segments > 0 ? Value(v) : Value(); };
  figure([&](Report r) { return drift(r, r.drift.overall.translation_percent); }, 4);
  figure([&](Report r) { return drift(r, r.drift.overall.rotation_deg_per_100m); }, 4);
  figure([](Report r) -> Value { return r.relative.translation.rmse; }, 4);
  figure([](Report r) -> Value { return r.relative.rotation_deg.rmse; }, 4);
  figure([](Report r) -> Value { return r.absolute.translation.rmse; }, 3);
  figure([](Report r) -> Value { return r.absolute.rotation_deg.rmse; }, 3);
  figure([](Report r) { return r.forward_ratio; }, 4);
  figure([](Report r) -> Value { return r.end.translation; }, 3);
  const SegmentationScores* labels =
      whole && run.labels ? &run.labels->evaluator.scores() : nullptr;
  cells.emplace_back(labels ? labels->iou() : Value(), 4);
  cells.emplace_back(labels ? labels->precision() : Value(), 4);
  cells.emplace_back(labels ? labels->recall() : Value(), 4);
  cells.emplace_back(whole ? number(run.report, "ms_per_scan") : Value(), 1);
  table.addRow(std::move(cells));
}

Table runTable(const std::vector<RunScores>& runs)
{
  Table table({"run", "trajectory", "scans", "length [m]", "t_rel [%]", "r_rel [deg/100m]",
               "RPE [m]", "RPE [deg]", "ATE [m]", "ATE [deg]", "forward", "end [m]", "IoU",
               "precision", "recall", "ms/scan"});
  for (const auto& run : runs)
  {
    addRow(table, run, "final", run.trajectory, true);
    if (run.odometry)
    {
      addRow(table, run, "odometry", run.odometry, false);
    }
  }
  return table;
}

/** Times of the stages in the report, if any. */
Json stageTimes(const RunScores& run)
{
  const auto times = run.report.find("stage_ms");
  return times != run.report.end() && times->is_object() ? *times : Json::object();
}

/** Mean time of each stage, one column per run. */
Table stageTable(const std::vector<RunScores>& runs)
{
  std::vector<std::string> columns{"stage [ms per scan]"};
  std::vector<std::string> stages;
  std::set<std::string> known;
  for (const auto& run : runs)
  {
    columns.push_back(run.name);
    const Json times = stageTimes(run);
    for (const auto& [stage, time] : times.items())
    {
      if (known.insert(stage).second)
      {
        stages.push_back(stage);
      }
    }
  }
  Table table(columns);
  for (const auto& stage : stages)
  {
    std::vector<TableCell> cells{stage};
    for (const auto& run : runs)
    {
      cells.emplace_back(number(stageTimes(run), stage.c_str()), 2);
    }
    table.addRow(std::move(cells));
  }
  return table;
}

Json neesJson(const NormalisedErrors& errors)
{
  return Json{{"count", errors.all.count},
              {"mean", errors.all.mean},
              {"median", errors.all.median},
              {"translation_mean", errors.translation.mean},
              {"rotation_mean", errors.rotation.mean}};
}

std::string runJson(const std::vector<RunScores>& runs)
{
  Json json;
  json["runs"] = Json::array();
  for (const auto& run : runs)
  {
    Json entry{{"name", run.name}, {"report", run.report}};
    if (run.trajectory)
    {
      entry["trajectory"] = Json::parse(trajectoryJson({*run.trajectory}))["trajectories"][0];
    }
    if (run.odometry)
    {
      entry["odometry"] = Json::parse(trajectoryJson({*run.odometry}))["trajectories"][0];
    }
    if (run.consistency)
    {
      entry["odometry_nees"] = {{"steps", neesJson(run.consistency->steps)},
                                {"keyframes", neesJson(run.consistency->keyframes)}};
    }
    if (run.labels)
    {
      entry["segmentation"] =
          Json::parse(segmentationJson({{run.name, *run.labels}}))["segmentation"][0];
    }
    json["runs"].push_back(entry);
  }
  return textOf(json);
}

void run(const Arguments& a)
{
  if (!a.truth.empty() && !fs::is_directory(a.truth))
  {
    throw UserError("--truth " + a.truth + ": is not a folder");
  }
  const auto names = shortNames(a.folders);
  std::vector<RunScores> runs;
  for (std::size_t i = 0; i < a.folders.size(); ++i)
  {
    runs.push_back(scoresOf(a.folders[i], a));
    runs.back().name = names[i];
  }
  a.output.write(runTable(runs), runJson(runs));
  std::vector<OdometryConsistency> consistencies;
  for (RunScores& one : runs)
  {
    if (one.consistency)
    {
      one.consistency->name = one.name;
      consistencies.push_back(*one.consistency);
    }
  }
  if (!consistencies.empty())
  {
    std::cout << '\n' << consistencyTable(consistencies).toText();
  }
  const Table stages = stageTable(runs);
  if (stages.rows() > 0)
  {
    std::cout << '\n' << stages.toText();
  }
}
}  // namespace

Subcommand runCommand(CLI::App& app)
{
  const auto a = std::make_shared<Arguments>();
  CLI::App* sub = app.add_subcommand(
      "run", "All metrics available for the output folders of runs, in one table");
  sub->add_option("folders", a->folders, "output folders of dyslam")->required();
  sub->add_option("--truth", a->truth,
                  "ground-truth folder (.gt) for labels and, where the run has none, "
                  "poses; default: next to the rawlog");
  a->metrics.declare(*sub);
  a->output.declare(*sub);
  return {sub, [a] { run(*a); }};
}
}  // namespace dyslam
