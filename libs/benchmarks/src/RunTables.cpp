// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/RunTables.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;
using Value = std::optional<double>;

constexpr const char* final_is_odometry = "final = odometry";

/** Cells of runTable() from the third column on. \param whole with what there is once per run */
std::vector<TableCell> figuresOf(const RunScores& run,
                                 const std::optional<TrajectoryReport>& trajectory,
                                 bool whole)
{
  std::vector<TableCell> cells{TableCell(whole ? Value(run.report.frames) : Value(), 0)};
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
  return cells;
}

/** Lines about runs: those of equal text become one. */
class RunLines
{
 public:
  void add(const std::string& run, const std::string& text)
  {
    const auto same = std::find_if(lines_.begin(), lines_.end(),
                                   [&](const Line& line) { return line.text == text; });
    Line& line = same != lines_.end() ? *same : lines_.emplace_back(Line{{}, text});
    line.runs.push_back(run);
  }
  /** The lines, in the order of their first runs. */
  [[nodiscard]] std::string text() const
  {
    std::string text;
    for (const Line& line : lines_)
    {
      text += joined(line.runs) + ": " + line.text + '\n';
    }
    return text;
  }

 private:
  struct Line
  {
    std::vector<std::string> runs;
    std::string text;
  };
  std::vector<Line> lines_;
};

/** Whether two runs are of one recording, maybe of parts of it that overlap: most true poses at the
 * times of both are the same. Recordings whose times begin at 0 have times in common, but drive
 * elsewhere; one recording may have been converted to several rawlogs. */
bool areOfOneRecording(const RunScores& a, const RunScores& b)
{
  constexpr double same_time = 1e-4;   // [s]
  constexpr double same_place = 1e-3;  // [m]
  std::size_t common = 0;
  std::size_t equal = 0;
  for (const StampedPose& pose : a.true_poses)
  {
    const auto other = b.true_poses.nearest(pose.stamp, same_time);
    if (other)
    {
      const Pose& place = b.true_poses[*other].pose;
      const double distance = (pose.pose.translation() - place.translation()).norm();
      ++common;
      equal += distance <= same_place ? 1 : 0;
    }
  }
  return common > 1 && 2 * equal > common;
}

/** Whether a mean of the runs has a meaning: two or more with ground truth, all of different
 * recordings. */
bool haveMean(const std::vector<RunScores>& runs)
{
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    if (!runs[i].trajectory)
    {
      return false;
    }
    for (std::size_t k = 0; k < i; ++k)
    {
      if (areOfOneRecording(runs[i], runs[k]))
      {
        return false;
      }
    }
  }
  return runs.size() > 1;
}

/** Adds a row of means over the rows that have a number in the column; scans and length are sums.
 * \param rows cells of runTable() from the third column on */
void addMeanRow(Table& table,
                const std::string& part,
                const std::vector<std::vector<TableCell>>& rows)
{
  constexpr std::size_t sums = 2;  // of the first columns: scans and length
  constexpr std::array<int, 14> digits{0, 1, 4, 4, 4, 4, 3, 3, 4, 3, 4, 4, 4, 1};
  std::vector<TableCell> cells{"mean", part};
  for (std::size_t i = 0; i < digits.size(); ++i)
  {
    double sum = 0;
    double count = 0;
    for (const std::vector<TableCell>& row : rows)
    {
      sum += row[i].value.value_or(0);
      count += row[i].value ? 1 : 0;
    }
    cells.emplace_back(count > 0 ? Value(i < sums ? sum : sum / count) : Value(), digits[i]);
  }
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
  std::vector<std::vector<TableCell>> of_odometry;
  std::vector<std::vector<TableCell>> final_ones;
  bool is_optimised = false;
  const auto addRow = [&table](const std::string& run, const std::string& part,
                               const std::vector<TableCell>& figures)
  {
    std::vector<TableCell> cells{run, part};
    cells.insert(cells.end(), figures.begin(), figures.end());
    table.addRow(std::move(cells));
  };
  for (const auto& run : runs)
  {
    const bool same = run.trajectory && run.odometry && run.odometryIsFinal();
    final_ones.push_back(figuresOf(run, run.trajectory, true));
    addRow(run.name, same ? final_is_odometry : "final", final_ones.back());
    if (run.odometry)
    {
      of_odometry.push_back(figuresOf(run, run.odometry, false));
    }
    if (run.odometry && !same)
    {
      is_optimised = true;
      addRow(run.name, "odometry", of_odometry.back());
    }
  }
  if (haveMean(runs))
  {
    addMeanRow(table, is_optimised || of_odometry.empty() ? "final" : final_is_odometry,
               final_ones);
    if (is_optimised)
    {
      addMeanRow(table, "odometry", of_odometry);
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
  RunLines lines;
  for (const RunScores& run : runs)
  {
    if (!run.world)
    {
      continue;
    }
    const auto split = splitOf(run, DataSplits::load("splits", "splits.ini"));
    lines.add(run.name, "seed " + std::to_string(run.world->seed) + " of the simulator, " +
                            (split ? toString(*split) : "of no split"));
  }
  return lines.text();
}

std::string truthLines(const std::vector<RunScores>& runs)
{
  RunLines lines;
  RunLines differences;
  for (const RunScores& run : runs)
  {
    if (!run.trajectory)
    {
      continue;
    }
    lines.add(run.name, "ground truth: " + printable(run.truth.text()) +
                            (run.truth.isExact() ? ""
                                                 : "; its own errors are part of all figures, most "
                                                   "of all of RPE; no NEES"));
    if (const std::string other = run.truth.differenceTo(); !other.empty())
    {
      differences.add(run.name,
                      "the figures are differences to " + other +
                          ": they show gross errors, but differences of some decimetres, or of a "
                          "few per cent of the path, may be of either (dyslam-eval map --self "
                          "compares the maps along both)");
    }
  }
  return lines.text() + differences.text();
}

std::string labelLines(const std::vector<RunScores>& runs)
{
  constexpr double nearly_all = 0.95;  // share of labelled points that is not worth a line
  RunLines kinds;
  RunLines shares;
  for (const RunScores& run : runs)
  {
    if (!run.labels)
    {
      continue;
    }
    if (run.labels_with_hindsight)
    {
      kinds.add(run.name, std::string("labels: ") + (*run.labels_with_hindsight
                                                         ? "with hindsight (offline, non-causal)"
                                                         : "causal"));
    }
    const auto labelled = run.labels->evaluator.scores().labelledShare();
    if (labelled && *labelled < nearly_all)
    {
      shares.add(run.name, formatted("labels: %.3g %% of the points are labelled in the ground "
                                     "truth; IoU, precision and recall are of these",
                                     100 * *labelled));
    }
  }
  return kinds.text() + shares.text();
}

std::string warningLines(const std::vector<RunScores>& runs)
{
  RunLines lines;
  for (const RunScores& run : runs)
  {
    if (!run.report.failure.empty())
    {
      lines.add(run.name, "unusable: " + printable(run.report.failure));
    }
    for (const std::string& warning : run.report.warnings)
    {
      lines.add(run.name, "warning: " + printable(warning));
    }
  }
  return lines.text();
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
