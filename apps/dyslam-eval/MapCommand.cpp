// SPDX-License-Identifier: BSD-3-Clause
#include "MapCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/eval/MapMetrics.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../common/Checks.h"
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
  std::vector<std::string> estimates;
  MapMetricsOptions metrics;
  MapSelfArguments self;
  std::string poses_of = "vehicle";
  OutputFlags output;
};

/** Labels stored in the intensity: 0 static and 1 dynamic (KTH's benchmark), or SemanticKITTI
 * classes (ERASOR's maps). */
std::vector<Label> labelsFromIntensity(const Scan& cloud, const std::string& path)
{
  if (cloud.intensity.size() != cloud.size())
  {
    throw UserError(path + ": has no labels; give --labels F.label, or put them in the intensity");
  }
  const bool only_flags = std::all_of(cloud.intensity.begin(), cloud.intensity.end(),
                                      [](float v) { return v == 0.0F || v == 1.0F; });
  std::vector<Label> labels;
  for (const float v : cloud.intensity)
  {
    if (!(v >= 0) || v != std::floor(v) || v > 65535)
    {
      throw UserError(path + ": intensity " + std::to_string(v) +
                      " is no label (0 static, 1 dynamic, or SemanticKITTI classes)");
    }
    labels.push_back(only_flags ? (v == 1.0F ? label_moving : label_static)
                                : static_cast<Label>(v));
  }
  return labels;
}

std::vector<Label> referenceLabels(const MapArguments& a, const Scan& cloud)
{
  const std::string beside =
      std::filesystem::path(a.reference).replace_extension(".label").string();
  if (!a.labels.empty() || std::filesystem::exists(beside))
  {
    return readLabels(a.labels.empty() ? beside : a.labels, cloud.size());
  }
  return labelsFromIntensity(cloud, a.reference);
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
  const Scan reference = readCloud(a.reference);
  const std::vector<Label> labels = referenceLabels(a, reference);
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
  for (const char* other : {"--reference", "--labels", "--radius", "--voxel"})
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
      "Static points preserved and dynamic points rejected by a map; with --self, the sharpness of "
      "the map of a trajectory, without ground truth");
  sub->add_option("--reference", a->reference,
                  "map (pcd, ply) of all points; labels in F.label beside it or in its intensity");
  sub->add_option("--labels", a->labels, "SemanticKITTI labels of the reference's points");
  sub->add_option(
         "--estimate", a->estimates,
         "maps to evaluate (pcd, ply), or trajectories (TUM, KITTI) with --self; any number")
      ->required();
  sub->add_option("--radius", a->metrics.point_radius,
                  "largest distance of a map point from a reference point (SA, DA) [m]")
      ->check(positive())
      ->capture_default_str();
  sub->add_option("--voxel", a->metrics.voxel_size, "side of the voxels (PR, RR) [m]")
      ->check(positive())
      ->capture_default_str();
  declareSelf(*sub, *a);
  a->output.declare(*sub);
  return {sub, [a] { runMap(*a); }};
}
}  // namespace dyslam
