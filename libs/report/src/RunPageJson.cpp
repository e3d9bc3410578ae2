// SPDX-License-Identifier: BSD-3-Clause
#include "RunPageJson.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/base/Version.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "PageTrajectories.h"
#include "PageValues.h"

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;

/** Its states at every n-th scan, by the number among these; the first one where there is none. */
PageObject atEveryNth(const PageObject& object, std::size_t step)
{
  PageObject result{object.id, object.object_class, {}};
  for (const PageObjectState& state : object.states)
  {
    if (state.scan % step == 0)
    {
      result.states.push_back(state);
    }
  }
  if (result.states.empty())
  {
    result.states.push_back(object.states.front());
  }
  for (PageObjectState& state : result.states)
  {
    state.scan /= step;
  }
  return result;
}

/** Counts over all scans, not those shown alone. */
Json totalsJson(const RunPage& page)
{
  const auto count = [&](bool PageScan::*flag)
  {
    return std::count_if(page.scans.begin(), page.scans.end(),
                         [flag](const PageScan& scan) { return scan.*flag; });
  };
  const Trajectory& t = page.trajectory;
  const double seconds = t.empty() ? 0 : t[t.size() - 1].stamp - t[0].stamp;
  return {{"scans", page.scans.size()},
          {"registered", count(&PageScan::registered)},
          {"keyframes", count(&PageScan::keyframe)},
          {"loops", page.loops.size()},
          {"loops_left_out", page.loops_left_out},
          {"reported_tracks", page.reported_tracks},
          {"correction", rounded(largestCorrection(page), millimetre)},
          {"seconds", rounded(seconds, millimetre)}};
}

/** Every n-th scan; `registered`: whether it and those up to the next shown one are. */
Json scansJson(const RunPage& page, std::size_t step)
{
  Json json;
  json["step"] = step;
  for (const char* name : {"index", "time", "points", "moving", "registered"})
  {
    json[name] = Json::array();
  }
  for (std::size_t i = 0; i < page.scans.size(); i += step)
  {
    const PageScan& scan = page.scans[i];
    json["index"].push_back(scan.index);
    json["time"].push_back(
        rounded(page.trajectory[i].stamp - page.trajectory[0].stamp, millimetre));
    json["points"].push_back(scan.points);
    json["moving"].push_back(scan.moving_points);
    json["registered"].push_back(std::all_of(
        page.scans.begin() + static_cast<std::ptrdiff_t>(i),
        page.scans.begin() + static_cast<std::ptrdiff_t>(std::min(i + step, page.scans.size())),
        [](const PageScan& s) { return s.registered; }));
  }
  json["speed"] = rounded(everyNth(speeds(page.trajectory), step), millimetre);
  return json;
}

/** Positions of every n-th keyframe, which is one of all scans. */
Json keyframesJson(const RunPage& page, std::size_t max_keyframes)
{
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t i = 0; i < page.scans.size(); ++i)
  {
    if (page.scans[i].keyframe)
    {
      positions.emplace_back(page.trajectory[i].pose.translation());
    }
  }
  const std::size_t step = stepFor(positions.size(), max_keyframes);
  Json json{{"step", step}, {"position", Json::array()}};
  for (const Eigen::Vector3d& position : everyNth(positions, step))
  {
    json["position"].push_back(rounded(position, 0.01));
  }
  return json;
}

/** Scans of one further lidar. */
struct FurtherLidar
{
  std::set<std::size_t> merged_into;
  std::vector<double> offsets;  //!< stamps relative to the scans that they were merged into [s]
  std::size_t points = 0;
};

/** A row per further lidar: its merged scans in numbers. */
Json furtherLidarsJson(const RunPage& page)
{
  std::map<std::size_t, double> stamps;
  for (std::size_t i = 0; i < page.scans.size(); ++i)
  {
    stamps[page.scans[i].index] = page.trajectory[i].stamp;
  }
  std::map<std::string, FurtherLidar> lidars;
  for (const PageScanPart& part : page.parts)
  {
    const auto into = stamps.find(part.scan);
    if (into != stamps.end())
    {
      FurtherLidar& lidar = lidars[part.sensor_label];
      lidar.merged_into.insert(part.scan);
      lidar.offsets.push_back(part.stamp - into->second);
      lidar.points += part.points;
    }
  }
  Json json = Json::array();
  for (auto& [label, lidar] : lidars)
  {
    const std::size_t count = lidar.offsets.size();
    const double largest =
        *std::max_element(lidar.offsets.begin(), lidar.offsets.end(),
                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    json.push_back({{"label", label},
                    {"scans", count},
                    {"merged_into", lidar.merged_into.size()},
                    {"offset_ms", rounded(1e3 * upperMedian(lidar.offsets), 0.1)},
                    {"largest_offset_ms", rounded(1e3 * largest, 0.1)},
                    {"points", lidar.points / count}});
  }
  return json;
}

/** What satellite positions and accelerations show; null without. */
void addEarth(const RunPage& page, Json& json)
{
  json["georeference"] = Json();
  if (page.georeference)
  {
    const Georeference& g = *page.georeference;
    json["georeference"] = {{"fixes", g.fixes},
                            {"fused", g.fused},
                            {"epsg", g.epsg},
                            {"horizontal_rmse", rounded(g.horizontal_rmse, 0.01)},
                            {"vertical_rmse", rounded(g.vertical_rmse, 0.01)}};
  }
  json["gravity"] = Json();
  if (page.gravity)
  {
    const Gravity& g = *page.gravity;
    json["gravity"] = {{"tilt_deg", rounded(g.tilt / radians_per_degree, 0.1)},
                       {"tilt_sigma_deg", rounded(g.tilt_sigma / radians_per_degree, 0.1)},
                       {"levelled", g.levelled}};
  }
}

/** How the run fits the prior map; null without one. */
void addPriorMap(const RunPage& page, Json& json)
{
  json["prior_map"] = Json();
  if (page.prior_map)
  {
    const PriorMapFit& fit = *page.prior_map;
    json["prior_map"] = {{"localised", fit.localised},
                         {"path_length", rounded(fit.path_length, 0.1)},
                         {"keyframes", fit.tried},
                         {"registered", fit.registered},
                         {"rmse", rounded(fit.rmse, 0.001)}};
  }
}

Json objectJson(const PageObject& object)
{
  Json json{{"id", object.id}, {"class", toString(object.object_class)}};
  for (const char* name : {"scan", "x", "y", "z", "yaw", "length", "width", "height", "speed"})
  {
    json[name] = Json::array();
  }
  for (const PageObjectState& state : object.states)
  {
    const Box& box = state.box;
    json["scan"].push_back(state.scan);
    json["x"].push_back(rounded(box.centre.x(), 0.01));
    json["y"].push_back(rounded(box.centre.y(), 0.01));
    json["z"].push_back(rounded(box.centre.z(), 0.01));
    json["yaw"].push_back(rounded(box.yaw, 1e-3));
    json["length"].push_back(rounded(box.size.x(), 0.01));
    json["width"].push_back(rounded(box.size.y(), 0.01));
    json["height"].push_back(rounded(box.size.z(), 0.01));
    json["speed"].push_back(rounded(state.velocity.norm(), 0.01));
  }
  return json;
}

/** Numbers of points and their coordinates. */
Json mapJson(const RunPage& page, const PackedPoints& points)
{
  const std::size_t given = page.map_points == nullptr ? 0 : page.map_points->size();
  return {{"count", points.count},
          {"of", std::max(given, page.map_size)},
          {"ceilings", points.ceilings},
          {"voxel", rounded(points.voxel_size, millimetre)},
          {"low", rounded(points.low, 1e-6)},
          {"step", rounded(points.step, 1e-9)}};
}
}  // namespace

nlohmann::ordered_json runPageJson(const RunPage& page,
                                   const PackedPoints& points,
                                   std::size_t max_scans)
{
  const std::size_t step = stepFor(page.scans.size(), max_scans);
  Json json;
  json["version"] = DYSLAM_VERSION;
  json["title"] = page.title;
  json["input"] = page.input;
  json["sensor"] = page.sensor;
  json["reference_origin"] = page.reference_origin;
  json["difference_to"] = page.difference_to;
  json["method"] = page.method;
  json["settings"] = page.settings;
  json["verdict"] = page.verdict;
  json["failure"] = page.failure;
  json["warnings"] = page.warnings;
  json["files"] = page.files;
  json["stage_ms"] = Json::object();
  for (const auto& [stage, ms] : page.stage_ms)
  {
    json["stage_ms"][stage] = rounded(ms, 1e-4);
  }
  json["run_time"] = rounded(page.run_time, 0.01);
  json["recording_time"] = rounded(page.recording_time, 0.01);
  json["totals"] = totalsJson(page);
  json["scans"] = scansJson(page, step);
  json["keyframes"] = keyframesJson(page, max_scans);
  json["further_lidars"] = furtherLidarsJson(page);
  addEarth(page, json);
  addPriorMap(page, json);
  addTrajectories(page, step, max_scans, json);
  const auto lengths = page.trajectory.pathLengths();
  json["length"] = rounded(lengths.empty() ? 0 : lengths.back(), 0.01);
  addErrors(page, max_scans, json);
  json["loops"] = Json::array();
  for (const PageLoop& loop : everyNth(page.loops, stepFor(page.loops.size(), max_scans)))
  {
    json["loops"].push_back(
        {{"from", rounded(loop.from, millimetre)}, {"to", rounded(loop.to, millimetre)}});
  }
  json["objects"] = Json::array();
  for (const PageObject& object : page.objects)
  {
    json["objects"].push_back(objectJson(atEveryNth(object, step)));
  }
  json["map"] = mapJson(page, points);
  return json;
}
}  // namespace dyslam
