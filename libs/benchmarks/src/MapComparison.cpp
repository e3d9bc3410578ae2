// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/benchmarks/DistanceCloud.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/MapComparison.h>
#include <dyslam/eval/MapDistance.h>
#include <dyslam/eval/SegmentationMetrics.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

namespace dyslam
{
namespace
{
/** Whether every point has the same intensity. */
bool isConstant(const std::vector<float>& intensity)
{
  return std::all_of(intensity.begin(), intensity.end(),
                     [&](float v) { return v == intensity.front(); });
}

/** Labels stored in the intensity: 0 static and 1 dynamic (KTH's benchmark), or SemanticKITTI
 * classes (ERASOR's maps). Other intensities, and those of which all are the same, are measured. */
ReferenceLabels labelsFromIntensity(const Scan& cloud)
{
  ReferenceLabels result;
  if (cloud.intensity.empty() || cloud.intensity.size() != cloud.size())
  {
    result.missing = "no intensity, no .label file";
    return result;
  }
  const bool only_flags = std::all_of(cloud.intensity.begin(), cloud.intensity.end(),
                                      [](float v) { return v == 0.0F || v == 1.0F; });
  for (const float v : cloud.intensity)
  {
    if (!(v >= 0) || v != std::floor(v) || v > 65535 ||
        !isSemanticKittiClass(static_cast<std::uint16_t>(v)))
    {
      return {{}, "intensity " + std::to_string(v) + " is none", ""};
    }
    result.labels.push_back(only_flags ? (v == 1.0F ? label_moving : label_static)
                                       : static_cast<Label>(v));
  }
  if (isConstant(cloud.intensity))
  {
    return {{}, "all intensities are " + std::to_string(std::lround(cloud.intensity.front())), ""};
  }
  result.from_intensity = only_flags ? "0: static, 1: moving" : "SemanticKITTI classes";
  return result;
}

nlohmann::ordered_json toJson(const MapScores& s)
{
  return {{"static", s.static_total},
          {"static_preserved", s.static_preserved},
          {"dynamic", s.dynamic_total},
          {"dynamic_rejected", s.dynamic_rejected},
          {"unlabelled", s.unlabelled},
          {"preservation", orNull(s.preservation())},
          {"rejection", orNull(s.rejection())},
          {"harmonic_mean", orNull(harmonicMean(s.preservation(), s.rejection()))},
          {"geometric_mean", orNull(geometricMean(s.preservation(), s.rejection()))}};
}

nlohmann::ordered_json toJson(const DistanceSummary& s)
{
  nlohmann::ordered_json json{{"points", s.count},
                              {"mean_m", s.mean},
                              {"median_m", s.median},
                              {"rmse_m", s.rmse},
                              {"quantile95_m", s.quantile95},
                              {"max_m", s.max}};
  json["shares"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < s.shares.size(); ++i)
  {
    json["shares"].push_back({{"within_m", DistanceSummary::limits[i]}, {"share", s.shares[i]}});
  }
  return json;
}

void addDistanceRow(Table& table,
                    const std::string& name,
                    const std::string& points_of,
                    const DistanceSummary& s)
{
  std::vector<TableCell> cells{name, points_of, TableCell(static_cast<double>(s.count), 0)};
  for (const double distance : {s.mean, s.median, s.rmse, s.quantile95, s.max})
  {
    cells.emplace_back(distance, 4);
  }
  for (const double share : s.shares)
  {
    cells.emplace_back(100 * share, 2);
  }
  table.addRow(std::move(cells));
}

/** Requires points. \throws UserError if the map has no finite point. */
void requirePoints(const Scan& cloud, const std::string& path)
{
  if (std::none_of(cloud.points.begin(), cloud.points.end(),
                   [](const Eigen::Vector3f& point) { return point.allFinite(); }))
  {
    throw UserError(path + ": has no points");
  }
}
}  // namespace

ReferenceMap readReferenceMap(const std::string& path)
{
  return {path, readCloud(path)};
}

ReferenceLabels readReferenceLabels(const ReferenceMap& reference, const std::string& labels)
{
  const std::string beside =
      std::filesystem::path(reference.path).replace_extension(".label").string();
  if (!labels.empty() || std::filesystem::exists(beside))
  {
    return {readLabels(labels.empty() ? beside : labels, reference.cloud.size()), "", ""};
  }
  return labelsFromIntensity(reference.cloud);
}

MapComparisonReport compareByDistance(const ReferenceMap& reference,
                                      const std::vector<NamedMap>& maps,
                                      const std::string& distances)
{
  requirePoints(reference.cloud, reference.path);
  Table table({"map", "points of", "points", "mean [m]", "median [m]", "RMSE [m]", "95 % [m]",
               "max [m]", "0.1 m [%]", "0.2 m [%]", "0.5 m [%]"});
  nlohmann::ordered_json json;
  json["reference"] = reference.path;
  json["maps"] = nlohmann::ordered_json::array();
  for (const auto& [name, path] : maps)
  {
    const Scan estimate = readCloud(path);
    requirePoints(estimate, path);
    const MapDistance distance = mapDistance(reference.cloud.points, estimate.points);
    addDistanceRow(table, name, "estimate", distance.estimate);
    addDistanceRow(table, name, "reference", distance.reference);
    json["maps"].push_back({{"name", name},
                            {"estimate", toJson(distance.estimate)},
                            {"reference", toJson(distance.reference)}});
    if (!distances.empty())
    {
      writeWhole(distances, distancePly(estimate.points, distance.of_estimate));
    }
  }
  return {table, textOf(json)};
}

MapComparisonReport compareByLabels(const ReferenceMap& reference,
                                    const std::vector<Label>& labels,
                                    const std::vector<NamedMap>& maps,
                                    const MapMetricsOptions& metrics)
{
  Table table({"map", "points", "SA [%]", "DA [%]", "HA [%]", "AA [%]", "PR [%]", "RR [%]", "F1"});
  nlohmann::ordered_json json;
  json["reference"] = reference.path;
  json["point_radius_m"] = metrics.point_radius;
  json["voxel_size_m"] = metrics.voxel_size;
  json["maps"] = nlohmann::ordered_json::array();
  const auto percent = [](std::optional<double> v)
  { return TableCell(v ? std::optional<double>(100 * *v) : std::nullopt, 2); };
  for (const auto& [name, path] : maps)
  {
    const Scan estimate = readCloud(path);
    const MapEvaluation e = evaluateMap(reference.cloud.points, labels, estimate.points, metrics);
    const auto sa = e.points.preservation();
    const auto da = e.points.rejection();
    const auto pr = e.voxels.preservation();
    const auto rr = e.voxels.rejection();
    table.addRow({name, TableCell(static_cast<double>(estimate.size()), 0), percent(sa),
                  percent(da), percent(harmonicMean(sa, da)), percent(geometricMean(sa, da)),
                  percent(pr), percent(rr), TableCell(harmonicMean(pr, rr), 4)});
    json["maps"].push_back({{"name", name},
                            {"points", estimate.size()},
                            {"by_point", toJson(e.points)},
                            {"by_voxel", toJson(e.voxels)}});
  }
  return {table, textOf(json)};
}
}  // namespace dyslam
