// SPDX-License-Identifier: BSD-3-Clause
#include "MapCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/Printable.h>
#include <dyslam/eval/MapDistance.h>
#include <dyslam/eval/MapMetrics.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "../common/Checks.h"
#include "../common/OutputOptions.h"
#include "MapSelf.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct MapArguments
{
  std::string reference;
  std::string labels;
  std::string distances;      //!< PLY to write
  bool needs_labels = false;  //!< flags were given that need them
  std::vector<std::string> estimates;
  MapMetricsOptions metrics;
  MapSelfArguments self;
  std::string poses_of = "vehicle";
  OutputFlags output;
};

/** Labels of a reference, or why it has none. */
struct ReferenceLabels
{
  std::vector<Label> labels;
  std::string missing;  //!< reason; empty: there are labels
};

/** Labels stored in the intensity: 0 static and 1 dynamic (KTH's benchmark), or SemanticKITTI
 * classes (ERASOR's maps). */
ReferenceLabels labelsFromIntensity(const Scan& cloud)
{
  if (cloud.intensity.size() != cloud.size())
  {
    return {{}, "no intensity, no .label file"};
  }
  const bool only_flags = std::all_of(cloud.intensity.begin(), cloud.intensity.end(),
                                      [](float v) { return v == 0.0F || v == 1.0F; });
  std::vector<Label> labels;
  for (const float v : cloud.intensity)
  {
    if (!(v >= 0) || v != std::floor(v) || v > 65535)
    {
      return {{}, "intensity " + std::to_string(v) + " is none"};
    }
    labels.push_back(only_flags ? (v == 1.0F ? label_moving : label_static)
                                : static_cast<Label>(v));
  }
  return {std::move(labels), ""};
}

ReferenceLabels referenceLabels(const MapArguments& a, const Scan& cloud)
{
  const std::string beside =
      std::filesystem::path(a.reference).replace_extension(".label").string();
  if (!a.labels.empty() || std::filesystem::exists(beside))
  {
    return {readLabels(a.labels.empty() ? beside : a.labels, cloud.size()), ""};
  }
  return labelsFromIntensity(cloud);
}

nlohmann::ordered_json toJson(const MapScores& s)
{
  const auto orNull = [](std::optional<double> v)
  { return v ? nlohmann::ordered_json(*v) : nlohmann::ordered_json(); };
  return {{"static", s.static_total},
          {"static_preserved", s.static_preserved},
          {"dynamic", s.dynamic_total},
          {"dynamic_rejected", s.dynamic_rejected},
          {"unlabelled", s.unlabelled},
          {"preservation", orNull(s.preservation())},
          {"rejection", orNull(s.rejection())},
          {"harmonic_mean", orNull(harmonicMean(s.preservation(), s.rejection()))}};
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

/** \throws UserError if the map has no finite point. */
void requirePoints(const Scan& cloud, const std::string& path)
{
  if (std::none_of(cloud.points.begin(), cloud.points.end(),
                   [](const Eigen::Vector3f& point) { return point.allFinite(); }))
  {
    throw UserError(path + ": has no points");
  }
}

/** Maps without labels: distances of the points of both from those of the other. */
void compareByDistance(const MapArguments& a, const Scan& reference)
{
  requirePoints(reference, a.reference);
  Table table({"map", "points of", "points", "mean [m]", "median [m]", "RMSE [m]", "95 % [m]",
               "max [m]", "0.1 m [%]", "0.2 m [%]", "0.5 m [%]"});
  nlohmann::ordered_json json;
  json["reference"] = a.reference;
  json["maps"] = nlohmann::ordered_json::array();
  const auto names = shortNames(a.estimates);
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const Scan estimate = readCloud(a.estimates[i]);
    requirePoints(estimate, a.estimates[i]);
    const MapDistance distance = mapDistance(reference.points, estimate.points);
    addDistanceRow(table, names[i], "estimate", distance.estimate);
    addDistanceRow(table, names[i], "reference", distance.reference);
    json["maps"].push_back({{"name", names[i]},
                            {"estimate", toJson(distance.estimate)},
                            {"reference", toJson(distance.reference)}});
    if (!a.distances.empty())
    {
      writeWhole(a.distances, distancePly(estimate.points, distance.of_estimate));
    }
  }
  a.output.write(table, textOf(json));
}

/** \throws UserError for a file that distances cannot be written to. */
void requireDistancesFile(const MapArguments& a)
{
  if (!a.distances.empty() && lowerExtension(a.distances) != ".ply")
  {
    throw UserError("--distances " + a.distances + ": the ending must be .ply");
  }
  if (!a.distances.empty() && a.estimates.size() > 1)
  {
    throw UserError("--distances writes the points of one --estimate, but " +
                    std::to_string(a.estimates.size()) + " were given");
  }
}

/** `--self`: evaluates trajectories by their maps. */
void runMapSelf(const MapArguments& a)
{
  MapSelfArguments self = a.self;
  self.trajectories = a.estimates;
  self.of_lidar = a.poses_of == "lidar";
  const auto scores = evaluateMapSelf(self);
  constexpr double square_millimetres = 1e6;  // in a square metre
  Table table({"trajectory", "scans", "points", "entropy", "plane variance [mm2]"});
  nlohmann::ordered_json json;
  json["rawlog"] = self.rawlog;
  json["neighbourhood_m"] = self.quality.radius;
  json["min_neighbours"] = self.quality.min_neighbours;
  json["trajectories"] = nlohmann::ordered_json::array();
  const auto names = shortNames(a.estimates);
  for (std::size_t i = 0; i < scores.size(); ++i)
  {
    const MapSharpness& mean = scores[i].mean;
    table.addRow({names[i], TableCell(static_cast<double>(scores[i].scans), 0),
                  TableCell(static_cast<double>(mean.points), 0), TableCell(mean.mean_entropy, 4),
                  TableCell(square_millimetres * mean.mean_plane_variance, 1)});
    json["trajectories"].push_back({{"name", names[i]},
                                    {"scans", scores[i].scans},
                                    {"points", mean.points},
                                    {"mean_map_entropy", mean.mean_entropy},
                                    {"mean_plane_variance_m2", mean.mean_plane_variance}});
  }
  a.output.write(table, textOf(json));
}

void runMap(const MapArguments& a)
{
  if (!a.self.rawlog.empty())
  {
    runMapSelf(a);
    return;
  }
  if (a.reference.empty())
  {
    throw UserError("map: give --reference MAP, or --self RAWLOG for quality without ground truth");
  }
  requireDistancesFile(a);
  const Scan reference = readCloud(a.reference);
  if (!a.distances.empty())
  {
    compareByDistance(a, reference);
    return;
  }
  const auto [labels, missing] = referenceLabels(a, reference);
  if (!missing.empty() && a.needs_labels)
  {
    throw UserError(a.reference + ": has no labels (" + missing +
                    "), which --radius and --voxel need; give --labels F.label, or omit them");
  }
  if (!missing.empty())
  {
    std::cerr << "note: " << printable(a.reference) << " has no labels (" << missing
              << "): the maps are compared by the distances of their points\n";
    compareByDistance(a, reference);
    return;
  }
  Table table({"map", "points", "SA [%]", "DA [%]", "HA [%]", "AA [%]", "PR [%]", "RR [%]", "F1"});
  nlohmann::ordered_json json;
  json["reference"] = a.reference;
  json["point_radius_m"] = a.metrics.point_radius;
  json["voxel_size_m"] = a.metrics.voxel_size;
  json["maps"] = nlohmann::ordered_json::array();
  const auto percent = [](std::optional<double> v)
  { return TableCell(v ? std::optional<double>(100 * *v) : std::nullopt, 2); };
  const auto names = shortNames(a.estimates);
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
  {
    const Scan estimate = readCloud(a.estimates[i]);
    const MapEvaluation e = evaluateMap(reference.points, labels, estimate.points, a.metrics);
    const auto sa = e.points.preservation();
    const auto da = e.points.rejection();
    const auto pr = e.voxels.preservation();
    const auto rr = e.voxels.rejection();
    table.addRow({names[i], TableCell(static_cast<double>(estimate.size()), 0), percent(sa),
                  percent(da), percent(harmonicMean(sa, da)), percent(geometricMean(sa, da)),
                  percent(pr), percent(rr), TableCell(harmonicMean(pr, rr), 4)});
    json["maps"].push_back({{"name", names[i]},
                            {"points", estimate.size()},
                            {"by_point", toJson(e.points)},
                            {"by_voxel", toJson(e.voxels)}});
  }
  a.output.write(table, textOf(json));
}

void declareSelf(CLI::App& sub, MapArguments& a)
{
  MapSelfArguments& self = a.self;
  const char* group = "Without ground truth";
  const auto option = [&](const char* name, auto& value, const char* help)
  { return sub.add_option(name, value, help)->group(group)->capture_default_str(); };
  CLI::Option* without_truth =
      option("--self", self.rawlog, "rawlog of the scans; --estimate are then trajectories");
  for (const char* other : {"--reference", "--labels", "--radius", "--voxel", "--distances"})
  {
    without_truth->excludes(other);
  }
  const auto of_self = [&](const char* name, auto& value, const char* help)
  { return option(name, value, help)->needs(without_truth); };
  of_self("-c,--config", self.config, "ini file whose [preprocess] is used");
  of_self("--neighbourhood", self.quality.radius, "radius around a point [m]")->check(positive());
  of_self("--min-neighbours", self.quality.min_neighbours, "points with fewer are left out")
      ->check(CLI::Range(4, 1000000));
  of_self("--points", self.points, "number of points whose neighbourhoods are evaluated")
      ->check(CLI::Range(1, 10000000));
  of_self("--tolerance", self.tolerance,
          "largest difference of time stamps where the pose of a scan cannot be interpolated [s]")
      ->check(notNegative());
  of_self("--poses-of", a.poses_of, "body of the poses: vehicle or lidar")
      ->check(CLI::IsMember({"vehicle", "lidar"}));
  of_self("--skip-first-n", self.source.skip_first_n, "scans to skip")->check(notNegative());
  of_self("--only-first-n", self.source.only_first_n, "scans to use after those; 0: all")
      ->check(notNegative());
}
}  // namespace

Subcommand mapCommand(CLI::App& app)
{
  const auto a = std::make_shared<MapArguments>();
  CLI::App* sub = app.add_subcommand(
      "map",
      "Static points preserved and dynamic points rejected by a map; of maps without labels, the "
      "distances of their points; with --self, the sharpness of the map of a trajectory, without "
      "ground truth");
  sub->add_option("--reference", a->reference,
                  "map (pcd, ply) of all points; labels in F.label beside it or in its intensity");
  CLI::Option* labels =
      sub->add_option("--labels", a->labels, "SemanticKITTI labels of the reference's points");
  sub->add_option(
         "--estimate", a->estimates,
         "maps to evaluate (pcd, ply), or trajectories (TUM, KITTI) with --self; any number")
      ->required();
  CLI::Option* radius =
      sub->add_option("--radius", a->metrics.point_radius,
                      "largest distance of a map point from a reference point (SA, DA) [m]")
          ->check(positive())
          ->capture_default_str();
  CLI::Option* voxel =
      sub->add_option("--voxel", a->metrics.voxel_size, "side of the voxels (PR, RR) [m]")
          ->check(positive())
          ->capture_default_str();
  addOutputFile(*sub, "--distances", a->distances,
                "compare by distance and write the estimate, coloured by the distance of each "
                "point from the reference, to this PLY file")
      ->excludes(labels)
      ->excludes(radius)
      ->excludes(voxel);
  declareSelf(*sub, *a);
  a->output.declare(*sub);
  return {sub, [a, radius, voxel]
          {
            a->needs_labels = radius->count() + voxel->count() > 0;
            runMap(*a);
          }};
}
}  // namespace dyslam
