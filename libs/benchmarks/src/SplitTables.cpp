// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/benchmarks/SplitTables.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/eval/PaperFigures.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

namespace dyslam
{
namespace
{
using Value = std::optional<double>;

/** A column with a number per drive. */
struct Figure
{
  std::string heading;
  int digits = 2;
  int best = 0;   //!< -1: the least of the row is bold, 1: the greatest, 0: none
  int group = 0;  //!< columns that are compared with each other
  std::function<Value(const DriveScores&)> of;
};

const RunScores* runOf(const DriveScores& drive, const std::string& folder)
{
  const auto run = drive.runs.find(folder);
  return run == drive.runs.end() ? nullptr : &run->second;
}

std::vector<RunColumn> withRuns(const std::vector<DriveScores>& drives,
                                const std::vector<RunColumn>& columns)
{
  std::vector<RunColumn> present;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(present),
               [&](const RunColumn& c)
               {
                 return std::any_of(drives.begin(), drives.end(),
                                    [&](const DriveScores& d)
                                    { return runOf(d, c.folder) != nullptr; });
               });
  return present;
}

/** The cells of a row; the best number of each group is bold if the others differ from it as
 * printed. */
std::vector<TableCell> cellsOf(const std::vector<Figure>& figures, const std::vector<Value>& values)
{
  const auto printed = [&](std::size_t i)
  { return std::round(*values[i] * std::pow(10, figures[i].digits)); };
  std::vector<TableCell> cells;
  for (std::size_t i = 0; i < figures.size(); ++i)
  {
    cells.emplace_back(values[i], figures[i].digits);
    bool beaten = !values[i];
    bool beats = false;
    for (std::size_t k = 0; k < figures.size() && !beaten; ++k)
    {
      const double lead = figures[k].group == figures[i].group && values[k]
                              ? figures[i].best * (printed(i) - printed(k))
                              : 0.0;
      beaten = lead < 0;
      beats = beats || lead > 0;
    }
    if (beats && !beaten)
    {
      cells.back().text = "**" + cells.back().text + "**";
    }
  }
  return cells;
}

bool hasValue(const std::vector<DriveScores>& drives, const Figure& figure)
{
  return std::any_of(drives.begin(), drives.end(),
                     [&](const DriveScores& drive) { return figure.of(drive).has_value(); });
}

/** A row for each drive and one of means: over the drives with all figures that any drive has. */
Table tableOf(const std::vector<DriveScores>& drives, const std::vector<Figure>& figures)
{
  std::vector<std::string> headings{"drive"};
  std::vector<bool> shown;
  for (const Figure& f : figures)
  {
    headings.push_back(f.heading);
    shown.push_back(hasValue(drives, f));
  }
  Table table(headings);
  std::vector<double> sums(figures.size(), 0.0);
  std::size_t complete = 0;
  const auto addRow = [&](const std::string& name, const std::vector<Value>& values)
  {
    std::vector<TableCell> cells{name};
    const std::vector<TableCell> numbers = cellsOf(figures, values);
    cells.insert(cells.end(), numbers.begin(), numbers.end());
    table.addRow(std::move(cells));
  };
  for (const DriveScores& drive : drives)
  {
    std::vector<Value> values;
    for (const Figure& f : figures)
    {
      values.push_back(f.of(drive));
    }
    addRow(drive.name, values);
    std::vector<bool> present;
    std::transform(values.begin(), values.end(), std::back_inserter(present),
                   [](const Value& v) { return v.has_value(); });
    if (present == shown)
    {
      ++complete;
      for (std::size_t i = 0; i < values.size(); ++i)
      {
        sums[i] += values[i].value_or(0);
      }
    }
  }
  std::vector<Value> means;
  for (std::size_t i = 0; i < sums.size(); ++i)
  {
    means.push_back(complete > 0 && shown[i] ? Value(sums[i] / static_cast<double>(complete))
                                             : Value());
  }
  addRow("mean of " + std::to_string(complete), means);
  return table;
}

Value number(const TrajectoryReport& report, double SegmentDrift::*value)
{
  return report.drift.overall.segments > 0 ? Value(report.drift.overall.*value) : Value();
}

/** A figure of the odometry or of the final trajectory of a folder's runs. */
std::function<Value(const DriveScores&)> ofTrajectory(
    const std::string& folder,
    std::optional<TrajectoryReport> RunScores::*trajectory,
    std::function<Value(const TrajectoryReport&)> value)
{
  return [=](const DriveScores& drive)
  {
    const RunScores* run = runOf(drive, folder);
    return run != nullptr && run->*trajectory ? value(*(run->*trajectory)) : Value();
  };
}

std::function<Value(const DriveScores&)> ofLabels(
    const std::string& folder, std::function<Value(const SegmentationScores&)> value)
{
  return [=](const DriveScores& drive)
  {
    const RunScores* run = runOf(drive, folder);
    if (run == nullptr || !run->labels)
    {
      return Value();
    }
    const SegmentationScores& scores = run->labels->evaluator.scores();
    return scores.true_positives + scores.false_negatives > 0 ? value(scores) : Value();
  };
}

/** Sequences of KITTI odometry with true poses, and their numbers of scans. */
constexpr std::array<std::pair<const char*, std::size_t>, 11> kitti_sequences{{{"00", 4541},
                                                                               {"01", 1101},
                                                                               {"02", 4661},
                                                                               {"03", 801},
                                                                               {"04", 271},
                                                                               {"05", 2761},
                                                                               {"06", 1101},
                                                                               {"07", 1101},
                                                                               {"08", 4071},
                                                                               {"09", 1591},
                                                                               {"10", 1201}}};

bool isKittiOdometry(const DriveScores& drive)
{
  const auto* sequence = std::find_if(kitti_sequences.begin(), kitti_sequences.end(),
                                      [&](const auto& one) { return drive.name == one.first; });
  return sequence != kitti_sequences.end() &&
         std::all_of(drive.runs.begin(), drive.runs.end(),
                     [&](const auto& run) { return run.second.report.frames == sequence->second; });
}

/** The paper's t_rel or r_rel of a method on a sequence of KITTI odometry. */
Figure paperFigure(const std::string& method, bool rotation)
{
  const auto part = rotation ? &PaperRow::r_rel_deg_per_100m : &PaperRow::t_rel_percent;
  return {"paper: " + method + (rotation ? " r_rel" : " t_rel"), 2, -1, rotation ? 1 : 0,
          [method, part](const DriveScores& drive)
          {
            Value value;
            if (!isKittiOdometry(drive))
            {
              return value;
            }
            for (const PaperRow& row : paperFigures("odometry/" + drive.name))
            {
              value = row.method == method ? row.*part : value;
            }
            return value;
          }};
}

/** t_rel and r_rel of a trajectory of each column's runs. */
std::vector<Figure> driftFigures(const std::vector<RunColumn>& columns,
                                 std::optional<TrajectoryReport> RunScores::*trajectory)
{
  std::vector<Figure> figures;
  for (const RunColumn& c : columns)
  {
    for (const bool rotation : {false, true})
    {
      const auto part =
          rotation ? &SegmentDrift::rotation_deg_per_100m : &SegmentDrift::translation_percent;
      figures.push_back(
          {c.heading + (rotation ? " r_rel" : " t_rel"), 2, -1, rotation ? 1 : 0,
           ofTrajectory(c.folder, trajectory,
                        [part](const TrajectoryReport& r) { return number(r, part); })});
    }
  }
  return figures;
}

/** Whether the graph changed the trajectory of a run of the column. */
bool isOptimised(const std::vector<DriveScores>& drives, const RunColumn& column)
{
  return std::any_of(drives.begin(), drives.end(),
                     [&](const DriveScores& drive)
                     {
                       const RunScores* run = runOf(drive, column.folder);
                       return run != nullptr && !run->odometryIsFinal();
                     });
}
}  // namespace

bool areKittiOdometry(const std::vector<DriveScores>& drives)
{
  const auto hasTruth = [](const DriveScores& drive)
  {
    return std::any_of(drive.runs.begin(), drive.runs.end(),
                       [](const auto& run) { return run.second.trajectory.has_value(); });
  };
  return std::any_of(drives.begin(), drives.end(), hasTruth) &&
         std::all_of(drives.begin(), drives.end(),
                     [&](const DriveScores& drive)
                     { return !hasTruth(drive) || isKittiOdometry(drive); });
}

Table driftTable(const std::vector<DriveScores>& drives, const std::vector<RunColumn>& columns)
{
  std::vector<Figure> figures = driftFigures(withRuns(drives, columns), &RunScores::odometry);
  if (areKittiOdometry(drives))
  {
    for (const char* method : {"LOAM", "DyLO"})
    {
      figures.push_back(paperFigure(method, false));
      figures.push_back(paperFigure(method, true));
    }
  }
  return tableOf(drives, figures);
}

std::vector<std::string> columnsWithoutDrift(const std::vector<DriveScores>& drives,
                                             const std::vector<RunColumn>& columns)
{
  std::vector<std::string> without;
  for (const RunColumn& c : withRuns(drives, columns))
  {
    const std::vector<Figure> figures = driftFigures({c}, &RunScores::odometry);
    if (std::none_of(figures.begin(), figures.end(),
                     [&](const Figure& figure) { return hasValue(drives, figure); }))
    {
      without.push_back(c.heading);
    }
  }
  return without;
}

Table finalDriftTable(const std::vector<DriveScores>& drives, const std::vector<RunColumn>& columns)
{
  std::vector<RunColumn> optimised;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(optimised),
               [&](const RunColumn& c) { return isOptimised(drives, c); });
  return optimised.empty() ? Table({"drive"})
                           : tableOf(drives, driftFigures(optimised, &RunScores::trajectory));
}

Table paperDriftTable(const std::vector<DriveScores>& drives, const std::vector<RunColumn>& columns)
{
  Table table({"method, in the paper", "t_rel", "r_rel"});
  for (const RunColumn& c : withRuns(drives, columns))
  {
    if (const auto published = paperMeanDrift(c.heading))
    {
      table.addRow({c.heading, TableCell(published->t_rel_percent, 2),
                    TableCell(published->r_rel_deg_per_100m, 2)});
    }
  }
  return table;
}

Table movingTable(const std::vector<DriveScores>& drives, const std::vector<RunColumn>& columns)
{
  const auto has_labels = [](const RunScores* run) { return run != nullptr && run->labels; };
  std::vector<RunColumn> shown;
  std::copy_if(columns.begin(), columns.end(), std::back_inserter(shown),
               [&](const RunColumn& c)
               {
                 return std::any_of(drives.begin(), drives.end(),
                                    [&](const DriveScores& d)
                                    { return has_labels(runOf(d, c.folder)); });
               });
  if (shown.empty())
  {
    return Table({"drive"});
  }
  const auto is_complete = [&](const DriveScores& drive)
  {
    return std::all_of(shown.begin(), shown.end(),
                       [&](const RunColumn& c) { return has_labels(runOf(drive, c.folder)); });
  };
  std::vector<Figure> figures;
  std::vector<Value> pooled;
  for (const RunColumn& c : shown)
  {
    SegmentationScores all;
    for (const DriveScores& drive : drives)
    {
      if (is_complete(drive))
      {
        all += runOf(drive, c.folder)->labels->evaluator.scores();
      }
    }
    int group = 0;
    const auto figure = [&](const char* name, Value (SegmentationScores::*score)() const)
    {
      figures.push_back(
          {c.heading + name, 3, 1, group++,
           ofLabels(c.folder, [score](const SegmentationScores& s) { return (s.*score)(); })});
      pooled.push_back((all.*score)());
    };
    figure(" IoU", &SegmentationScores::iou);
    figure(" precision", &SegmentationScores::precision);
    figure(" recall", &SegmentationScores::recall);
  }
  Table table = tableOf(drives, figures);
  std::vector<TableCell> cells{"all points"};
  const std::vector<TableCell> numbers = cellsOf(figures, pooled);
  cells.insert(cells.end(), numbers.begin(), numbers.end());
  table.addRow(std::move(cells));
  return table;
}

Table absoluteTable(const std::vector<DriveScores>& drives, const std::string& folder)
{
  const auto metres = [](const TrajectoryReport& r) { return Value(r.absolute.translation.rmse); };
  const auto degrees = [](const TrajectoryReport& r)
  { return Value(r.absolute.rotation_deg.rmse); };
  const auto loops = [folder](const DriveScores& drive)
  {
    const RunScores* run = runOf(drive, folder);
    return run != nullptr ? Value(run->report.loops) : Value();
  };
  return tableOf(
      drives,
      {{"odometry ATE [m]", 3, -1, 0, ofTrajectory(folder, &RunScores::odometry, metres)},
       {"final ATE [m]", 3, -1, 0, ofTrajectory(folder, &RunScores::trajectory, metres)},
       {"odometry ATE [deg]", 3, -1, 1, ofTrajectory(folder, &RunScores::odometry, degrees)},
       {"final ATE [deg]", 3, -1, 1, ofTrajectory(folder, &RunScores::trajectory, degrees)},
       {"loops", 0, 0, 2, loops}});
}

Table timeTable(const std::vector<DriveScores>& drives, const std::vector<RunColumn>& columns)
{
  Table table({"method [ms per scan]", "preprocess", "segmentation", "pose estimation", "all else",
               "overall", "scans"});
  for (const RunColumn& c : withRuns(drives, columns))
  {
    double scans = 0, preprocess = 0, segmentation = 0, pose = 0, overall = 0;
    for (const DriveScores& drive : drives)
    {
      const RunScores* run = runOf(drive, c.folder);
      const double per_scan = run != nullptr ? run->report.ms_per_scan.value_or(0) : 0;
      if (per_scan <= 0)
      {
        continue;  // no run, or it did not finish
      }
      const double frames = Value(run->report.frames).value_or(0);
      const auto stage = [&](const char* name)
      {
        const auto time = run->report.stage_ms.find(name);
        return time != run->report.stage_ms.end() ? frames * time->second : 0.0;
      };
      scans += frames;
      preprocess += stage("preprocess");
      segmentation += stage("dyseg");
      pose += stage("odometry") + stage("refine");
      overall += frames * per_scan;
    }
    const auto mean = [scans](double sum) { return scans > 0 ? Value(sum / scans) : Value(); };
    table.addRow({c.heading, TableCell(mean(preprocess), 1), TableCell(mean(segmentation), 1),
                  TableCell(mean(pose), 1),
                  TableCell(mean(overall - preprocess - segmentation - pose), 1),
                  TableCell(mean(overall), 1), TableCell(scans, 0)});
  }
  return table;
}

void addPaperTimes(Table& times)
{
  for (const PaperTimes& row : paperTimes())
  {
    times.addRow({"the paper: " + row.method, TableCell(row.preprocess_ms, 0), "-",
                  TableCell(row.pose_estimation_ms, 0), "-", TableCell(row.overall_ms, 0), "-"});
  }
}

Table drivesTable(const std::vector<DriveScores>& drives, const std::string& folder)
{
  Table table(
      {"drive", "world", "sensor", "traffic", "seed", "scans", "length [m]", "moving points [%]"});
  for (const DriveScores& drive : drives)
  {
    const RunScores* run = runOf(drive, folder);
    const SimulatedWorld world =
        run != nullptr ? run->world.value_or(SimulatedWorld()) : SimulatedWorld();
    Value moving;
    if (run != nullptr && run->labels)
    {
      const SegmentationScores& s = run->labels->evaluator.scores();
      const auto movers = static_cast<double>(s.true_positives + s.false_negatives);
      const double all =
          movers + static_cast<double>(s.true_negatives) + static_cast<double>(s.false_positives);
      moving = all > 0 ? Value(100 * movers / all) : Value();
    }
    const bool known = !world.world.empty();
    table.addRow(
        {drive.name, known ? world.world : "-", known ? world.sensor : "-",
         TableCell(known ? Value(world.traffic) : Value(), 2),
         TableCell(known ? Value(world.seed) : Value(), 0),
         TableCell(run != nullptr ? Value(run->report.frames) : Value(), 0),
         TableCell(run != nullptr && run->trajectory ? Value(run->trajectory->length) : Value(), 1),
         TableCell(moving, 1)});
  }
  return table;
}
}  // namespace dyslam
