// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RunFiles.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
using Json = nlohmann::ordered_json;

/** Rounds to nine digits, more than the accuracy of any figure of the report. */
double rounded(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return std::strtod(text, nullptr);
}

Json jsonOf(const Georeference& georeference)
{
  return {{"positions", georeference.fixes},
          {"horizontal_rmse_m", rounded(georeference.horizontal_rmse)},
          {"vertical_rmse_m", rounded(georeference.vertical_rmse)},
          {"fused", georeference.fused}};
}

Json jsonOf(const Gravity& gravity)
{
  const auto numbers = [](const Eigen::Vector3d& v) {
    return Json::array({rounded(v.x()), rounded(v.y()), rounded(v.z())});
  };
  return {{"directions", gravity.directions},
          {"rmse_deg", rounded(gravity.rmse / radians_per_degree)},
          {"map_tilt_deg", rounded(gravity.tilt / radians_per_degree)},
          {"map_tilt_sigma_deg", rounded(gravity.tilt_sigma / radians_per_degree)},
          {"up_map", numbers(gravity.up_map)},
          {"accelerometer_bias_mps2", numbers(gravity.bias)},
          {"fused", gravity.fused},
          {"levelled", gravity.levelled}};
}

Json jsonOf(const PriorMapFit& fit)
{
  Json json{{"localised", fit.localised}};
  if (fit.localised)
  {
    json["path_to_localisation_m"] = rounded(fit.path_length);
    json["keyframes"] = fit.tried;
    json["registered"] = fit.registered;
    json["found_again"] = fit.found_again;
    json["rmse_m"] = rounded(fit.rmse);
  }
  else
  {
    json["reason"] = fit.reason;
  }
  return json;
}

/** An object with the values, each passed through `round`. */
template <typename Round>
Json jsonOf(const std::map<std::string, double>& values, const Round& round)
{
  Json json = Json::object();
  for (const auto& [name, value] : values)
  {
    json[name] = round(value);
  }
  return json;
}

/** `report.json`: figures of the run. It is written last, marks the end of a run, and names files
 * that could not be written. */
class ReportOutput : public RunOutput
{
 public:
  explicit ReportOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::report}),
        input_(std::filesystem::absolute(context.settings.rawlog).lexically_normal().string()),
        sensor_(context.settings.sensor),
        truth_(poseOrigin(groundTruthFolder(context.settings.rawlog)))
  {
  }
  void checkpoint(const RunResults& results) override { write(results, false); }
  void finish(const RunResults& results) override
  {
    write(results, results.report.ended_early.empty());
  }

 private:
  void write(const RunResults& results, bool finished) const
  {
    constexpr int indent = 2;
    const std::string text =
        toJson(results, finished).dump(indent, ' ', false, Json::error_handler_t::replace);
    writeWhole(path(run_files::report), text + "\n");
  }

  [[nodiscard]] Json toJson(const RunResults& results, bool finished) const
  {
    SlamRunReport report = results.report;
    report.run_time = results.runTime();
    Json json;
    json["input"] = input_;
    json["sensor"] = sensor_;
    if (report.has_reference)
    {
      json["ground_truth"] = {{"source", toString(truth_.source)}, {"name", truth_.name}};
    }
    json["method"] = report.method;
    json["finished"] = finished;
    json["ended_early"] = report.ended_early;
    json["frames"] = report.frames;
    json["unconverged"] = report.unconverged;
    json["odometry_failed"] = report.odometry_failed;
    json["keyframes"] = report.keyframes;
    json["loops"] = report.loops;
    json["loops_left_out"] = report.loops_left_out;
    if (report.georeference)
    {
      json["gnss"] = jsonOf(*report.georeference);
    }
    if (report.gravity)
    {
      json["gravity"] = jsonOf(*report.gravity);
    }
    if (report.prior_map)
    {
      json["prior_map"] = jsonOf(*report.prior_map);
    }
    json["tracks"] = report.tracks;
    json["map_points"] = report.map_points;
    json["path_length_m"] = rounded(report.path_length);
    json["ms_per_scan"] = rounded(report.ms_per_scan);
    json["stage_ms"] = jsonOf(results.stage_ms, rounded);
    json["wait_ms"] = jsonOf(results.wait_ms, rounded);
    json["memory_mb"] =
        jsonOf(results.memory_mb, [](double mb) { return std::round(10 * mb) / 10; });
    json["recording_time_s"] = rounded(report.recording_time);
    json["run_time_s"] = rounded(report.run_time);
    json["realtime_factor"] = rounded(report.realtimeFactor());
    json["verdict"] = report.verdict;
    json["failure"] = report.failure;
    json["warnings"] = report.warnings;
    json["not_written"] = results.failures;
    json["files"] = report.files;
    json["files"].push_back(run_files::report);
    return json;
  }

  std::string input_;
  std::string sensor_;
  PoseOrigin truth_;
};
}  // namespace

std::unique_ptr<RunOutput> makeReportOutput(const RunOutputContext& context)
{
  return std::make_unique<ReportOutput>(context);
}
}  // namespace dyslam
