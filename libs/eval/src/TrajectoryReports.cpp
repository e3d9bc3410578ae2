// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/eval/PaperFigures.h>
#include <dyslam/eval/TrajectoryReports.h>

#include <nlohmann/json.hpp>

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;

std::optional<double> where(bool condition, double value)
{
  return condition ? std::optional<double>(value) : std::nullopt;
}

/** A segment length as it was given: 2.5, not 2. */
std::string lengthText(double length)
{
  return formatted("%g", length);
}

std::vector<TableCell> row(const TrajectoryReport& r)
{
  const bool has_segments = r.drift.overall.segments > 0;
  return {r.name,
          TableCell(static_cast<double>(r.pairs), 0),
          TableCell(r.length, 1),
          TableCell(where(has_segments, r.drift.overall.translation_percent), 4),
          TableCell(where(has_segments, r.drift.overall.rotation_deg_per_100m), 4),
          TableCell(where(r.relative.translation.count > 0, r.relative.translation.rmse), 4),
          TableCell(where(r.relative.rotation_deg.count > 0, r.relative.rotation_deg.rmse), 4),
          TableCell(r.absolute.translation.rmse, 3),
          TableCell(where(!r.positions_only, r.absolute.rotation_deg.rmse), 3),
          TableCell(r.forward_ratio, 4),
          TableCell(where(!r.positions_only, r.end.translation), 3),
          TableCell(where(!r.positions_only && r.length > 0, r.end.percent), 2)};
}

Json toJson(const Statistics& s)
{
  return Json{{"count", s.count},           {"max", s.max}, {"mean", s.mean},
              {"median", s.median},         {"min", s.min}, {"rmse", s.rmse},
              {"std", s.standard_deviation}};
}

Json toJson(const SegmentDrift& d)
{
  Json json;
  if (d.length > 0)
  {
    json["length_m"] = d.length;
  }
  json["segments"] = d.segments;
  json["t_rel_percent"] = d.segments > 0 ? Json(d.translation_percent) : Json();
  json["r_rel_deg_per_100m"] = d.segments > 0 ? Json(d.rotation_deg_per_100m) : Json();
  return json;
}

Json toJson(const TrajectoryReport& r)
{
  Json json;
  json["name"] = r.name;
  json["reference_poses"] = r.reference_size;
  json["estimated_poses"] = r.estimate_size;
  json["associated_poses"] = r.pairs;
  json["not_finite_poses"] = r.not_finite;
  json["length_m"] = r.length;
  json["kitti"] = toJson(r.drift.overall);
  for (const auto& d : r.drift.per_length)
  {
    json["kitti"]["per_length"].push_back(toJson(d));
  }
  const auto unlessMissing = [&r](const Json& figures)
  { return r.positions_only ? Json() : figures; };
  json["rpe"] = unlessMissing({{"translation_m", toJson(r.relative.translation)},
                               {"rotation_deg", toJson(r.relative.rotation_deg)}});
  json["ate"] = {{"alignment", toString(r.alignment)},
                 {"translation_m", toJson(r.absolute.translation)},
                 {"rotation_deg", unlessMissing(toJson(r.absolute.rotation_deg))}};
  json["forward_ratio"] = r.forward_ratio ? Json(*r.forward_ratio) : Json();
  json["end_error"] = unlessMissing({{"translation_m", r.end.translation},
                                     {"rotation_deg", r.end.rotation_deg},
                                     {"percent", r.end.percent}});
  return json;
}

void addStatistics(Table& table, const std::string& name, const std::string& error, Statistics s)
{
  table.addRow({name, error, TableCell(s.max, 4), TableCell(s.mean, 4), TableCell(s.median, 4),
                TableCell(s.min, 4), TableCell(s.rmse, 4), TableCell(s.standard_deviation, 4)});
}
}  // namespace

Table trajectoryTable(const std::vector<TrajectoryReport>& reports)
{
  Table table({"estimate", "poses", "length [m]", "t_rel [%]", "r_rel [deg/100m]", "RPE [m]",
               "RPE [deg]", "ATE [m]", "ATE [deg]", "forward", "end [m]", "end [%]"});
  for (const auto& report : reports)
  {
    table.addRow(row(report));
  }
  return table;
}

Table trajectoryTable(const std::vector<TrajectoryReport>& reports,
                      const std::string& paper_sequence)
{
  Table table = trajectoryTable(reports);
  for (const auto& figures : paperFigures(paper_sequence))
  {
    table.addRow(
        {"paper: " + figures.method, TableCell(std::nullopt, 0), TableCell(std::nullopt, 0),
         TableCell(figures.t_rel_percent, 2), TableCell(figures.r_rel_deg_per_100m, 2),
         TableCell(figures.rpe_translation_rmse, 2), TableCell(std::nullopt, 0),
         TableCell(figures.ate_translation_rmse, 3), TableCell(figures.ate_rotation_rmse_deg, 3),
         TableCell(std::nullopt, 0), TableCell(std::nullopt, 0), TableCell(std::nullopt, 0)});
  }
  return table;
}

Table errorStatisticsTable(const std::vector<TrajectoryReport>& reports)
{
  Table table({"estimate", "error", "max", "mean", "median", "min", "RMSE", "std"});
  for (const auto& r : reports)
  {
    if (r.positions_only)
    {
      addStatistics(table, r.name, "ATE [m]", r.absolute.translation);
      continue;
    }
    addStatistics(table, r.name, "RPE [m]", r.relative.translation);
    addStatistics(table, r.name, "RPE [deg]", r.relative.rotation_deg);
    addStatistics(table, r.name, "ATE [m]", r.absolute.translation);
    addStatistics(table, r.name, "ATE [deg]", r.absolute.rotation_deg);
  }
  return table;
}

Table driftTable(const std::vector<TrajectoryReport>& reports)
{
  std::vector<std::string> columns{"length [m]"};
  for (const auto& r : reports)
  {
    columns.push_back(r.name + " t_rel [%]");
    columns.push_back(r.name + " r_rel [deg/100m]");
  }
  Table table(columns);
  const std::size_t lengths = reports.empty() ? 0 : reports.front().drift.per_length.size();
  for (std::size_t i = 0; i < lengths; ++i)
  {
    std::vector<TableCell> cells{lengthText(reports.front().drift.per_length[i].length)};
    for (const auto& r : reports)
    {
      const auto& drift = r.drift.per_length.at(i);
      cells.emplace_back(where(drift.segments > 0, drift.translation_percent), 4);
      cells.emplace_back(where(drift.segments > 0, drift.rotation_deg_per_100m), 4);
    }
    table.addRow(std::move(cells));
  }
  return table;
}

std::string trajectoryJson(const std::vector<TrajectoryReport>& reports)
{
  Json json;
  json["trajectories"] = Json::array();
  for (const auto& report : reports)
  {
    json["trajectories"].push_back(toJson(report));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}
}  // namespace dyslam
