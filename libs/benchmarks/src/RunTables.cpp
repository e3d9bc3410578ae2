// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/RunTables.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;
using Value = std::optional<double>;

void addRunRow(Table& table,
               const RunScores& run,
               const std::string& part,
               const std::optional<TrajectoryReport>& trajectory,
               bool whole)
{
  std::vector<TableCell> cells{run.name, part,
                               TableCell(whole ? Value(run.report.frames) : Value(), 0)};
  const auto figure = [&](auto value, int digits)
  { cells.emplace_back(trajectory ? value(*trajectory) : std::optional<double>(), digits); };
  using Report = const TrajectoryReport&;
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
  const Value ms = whole ? run.report.ms_per_scan : Value();
  cells.emplace_back(ms.value_or(0) > 0 ? ms : Value(), 1);  // 0: the run did not finish
  table.addRow(std::move(cells));
}

Json neesJson(const NormalisedErrors& errors)
{
  return Json{{"count", errors.all.count},
              {"mean", errors.all.mean},
              {"median", errors.all.median},
              {"translation_mean", errors.translation.mean},
              {"rotation_mean", errors.rotation.mean}};
}
}  // namespace

Table runTable(const std::vector<RunScores>& runs)
{
  Table table({"run", "trajectory", "scans", "length [m]", "t_rel [%]", "r_rel [deg/100m]",
               "RPE [m]", "RPE [deg]", "ATE [m]", "ATE [deg]", "forward", "end [m]", "IoU",
               "precision", "recall", "ms/scan"});
  for (const auto& run : runs)
  {
    addRunRow(table, run, "final", run.trajectory, true);
    if (run.odometry)
    {
      addRunRow(table, run, "odometry", run.odometry, false);
    }
  }
  return table;
}

Table stageTable(const std::vector<RunScores>& runs)
{
  std::vector<std::string> columns{"stage [ms per scan]"};
  std::vector<std::string> stages;
  std::set<std::string> known;
  for (const auto& run : runs)
  {
    columns.push_back(run.name);
    for (const auto& [stage, time] : run.report.stage_ms)
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
      const auto time = run.report.stage_ms.find(stage);
      cells.emplace_back(time != run.report.stage_ms.end() ? Value(time->second) : Value(), 2);
    }
    table.addRow(std::move(cells));
  }
  return table;
}

std::vector<OdometryConsistency> consistenciesOf(const std::vector<RunScores>& runs)
{
  std::vector<OdometryConsistency> consistencies;
  for (const RunScores& one : runs)
  {
    if (one.consistency)
    {
      consistencies.push_back(*one.consistency);
      consistencies.back().name = one.name;
    }
  }
  return consistencies;
}

std::string splitLines(const std::vector<RunScores>& runs)
{
  std::string lines;
  for (const RunScores& run : runs)
  {
    if (!run.world)
    {
      continue;
    }
    const auto split = splitOf(run, DataSplits::load("splits", "splits.ini"));
    lines += run.name + ": seed " + std::to_string(run.world->seed) + " of the simulator, " +
             (split ? toString(*split) : "of no split") + "\n";
  }
  return lines;
}

std::string truthLines(const std::vector<RunScores>& runs)
{
  std::string lines;
  for (const RunScores& run : runs)
  {
    if (!run.trajectory)
    {
      continue;
    }
    lines += run.name + ": ground truth: " + printable(run.truth.text());
    if (!run.truth.isExact())
    {
      lines +=
          "; its own errors are part of all figures (those of GNSS/INS are up to a decimetre per "
          "scan, which RPE shows), and NEES is not computed, as it would take them for errors of "
          "the odometry";
    }
    lines += '\n';
    if (const std::string other = run.truth.differenceTo(); !other.empty())
    {
      lines += run.name + ": the figures are differences to " + other +
               ": they show gross errors, but differences of some decimetres, or of a few per cent "
               "of the path, may be of either (dyslam-eval map --self compares the maps along "
               "both)\n";
    }
  }
  return lines;
}

std::string labelLines(const std::vector<RunScores>& runs)
{
  constexpr double nearly_all = 0.95;  // share of labelled points that is not worth a line
  std::string lines;
  for (const RunScores& run : runs)
  {
    if (!run.labels)
    {
      continue;
    }
    if (run.labels_with_hindsight)
    {
      lines += run.name + ": labels: " +
               (*run.labels_with_hindsight ? "with hindsight (offline, non-causal)" : "causal") +
               '\n';
    }
    const auto labelled = run.labels->evaluator.scores().labelledShare();
    if (labelled && *labelled < nearly_all)
    {
      lines += run.name + formatted(
                              ": labels: %.3g %% of the points are labelled in the ground "
                              "truth; IoU, precision and recall are of these\n",
                              100 * *labelled);
    }
  }
  return lines;
}

std::string warningLines(const std::vector<RunScores>& runs)
{
  std::string lines;
  for (const RunScores& run : runs)
  {
    if (!run.report.failure.empty())
    {
      lines += run.name + ": unusable: " + printable(run.report.failure) + '\n';
    }
    for (const std::string& warning : run.report.warnings)
    {
      lines += run.name + ": warning: " + printable(warning) + '\n';
    }
  }
  return lines;
}

std::string runJson(const std::vector<RunScores>& runs)
{
  Json json;
  json["runs"] = Json::array();
  for (const auto& run : runs)
  {
    Json entry{{"name", run.name}, {"report", Json::parse(run.report_text)}};
    if (const auto split =
            run.world ? splitOf(run, DataSplits::load("splits", "splits.ini")) : std::nullopt)
    {
      entry["split"] = toString(*split);
    }
    if (run.trajectory)
    {
      entry["trajectory"] = Json::parse(trajectoryJson({*run.trajectory}))["trajectories"][0];
    }
    if (run.odometry)
    {
      entry["odometry"] = Json::parse(trajectoryJson({*run.odometry}))["trajectories"][0];
    }
    if (run.trajectory)
    {
      entry["ground_truth"] = {{"source", toString(run.truth.source)},
                               {"name", run.truth.name},
                               {"exact", run.truth.isExact()}};
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
      if (run.labels_with_hindsight)
      {
        entry["segmentation"]["hindsight"] = *run.labels_with_hindsight;
      }
    }
    json["runs"].push_back(entry);
  }
  return textOf(json);
}
}  // namespace dyslam
