// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "ReportFields.h"

namespace dyslam
{
namespace
{
constexpr const char* no_recording = "does not name the recording (\"input\")";

std::string reportPath(const std::string& folder)
{
  return (std::filesystem::path(folder) / run_files::report).string();
}

PoseOrigin poseOriginFrom(const ReportFields& fields)
{
  return {poseSourceFromString(fields.text("source")), fields.text("name")};
}

GnssFit gnssFrom(const ReportFields& fields)
{
  GnssFit fit;
  fit.positions = fields.count("positions").value_or(0);
  fit.horizontal_rmse = fields.number("horizontal_rmse_m").value_or(0);
  fit.vertical_rmse = fields.number("vertical_rmse_m").value_or(0);
  fit.fused = fields.flag("fused").value_or(false);
  return fit;
}

Gravity gravityFrom(const ReportFields& fields)
{
  const auto needed = [&fields](const char* key, const auto& value)
  {
    if (!value)
    {
      fields.fail("gravity has no number \"" + std::string(key) + "\"");
    }
    return *value;
  };
  const auto angle = [&](const char* key)
  { return radians_per_degree * needed(key, fields.number(key)); };
  Gravity gravity;
  gravity.tilt = angle("map_tilt_deg");
  gravity.tilt_sigma = angle("map_tilt_sigma_deg");
  gravity.directions = needed("directions", fields.count("directions"));
  gravity.rmse = radians_per_degree * fields.number("rmse_deg").value_or(0);
  gravity.bias = fields.vector("accelerometer_bias_mps2").value_or(Eigen::Vector3d::Zero());
  gravity.fused = fields.flag("fused").value_or(false);
  gravity.levelled = fields.flag("levelled").value_or(false);
  gravity.up_map = fields.vector("up_map").value_or(Eigen::Vector3d::Zero());
  if (!(std::abs(gravity.up_map.norm() - 1) < 1e-3))
  {
    fields.fail("gravity.up_map is no unit vector");
  }
  gravity.up_map.normalize();
  return gravity;
}

PriorMapFit priorMapFrom(const ReportFields& fields)
{
  PriorMapFit fit;
  fit.localised = fields.flag("localised").value_or(false);
  fit.reason = fields.text("reason");
  fit.path_length = fields.number("path_to_localisation_m").value_or(0);
  fit.tried = fields.count("keyframes").value_or(0);
  fit.registered = fields.count("registered").value_or(0);
  fit.found_again = fields.count("found_again").value_or(0);
  fit.rmse = fields.number("rmse_m").value_or(0);
  return fit;
}

/** Nothing if there is no such object. */
template <typename Result>
std::optional<Result> objectFrom(const ReportFields& fields,
                                 const char* key,
                                 Result (*read)(const ReportFields&))
{
  const auto object = fields.object(key);
  return object ? std::optional<Result>(read(*object)) : std::nullopt;
}

double inNineDigits(double value)
{
  return std::strtod(formatted("%.9g", value).c_str(), nullptr);
}

double inTenths(double value)
{
  return std::round(10 * value) / 10;
}

ReportJson toReportJson(const GnssFit& fit)
{
  return {{"positions", fit.positions},
          {"horizontal_rmse_m", inNineDigits(fit.horizontal_rmse)},
          {"vertical_rmse_m", inNineDigits(fit.vertical_rmse)},
          {"fused", fit.fused}};
}

ReportJson toReportJson(const Gravity& gravity)
{
  const auto numbers = [](const Eigen::Vector3d& v) {
    return ReportJson::array({inNineDigits(v.x()), inNineDigits(v.y()), inNineDigits(v.z())});
  };
  return {{"directions", gravity.directions},
          {"rmse_deg", inNineDigits(gravity.rmse / radians_per_degree)},
          {"map_tilt_deg", inNineDigits(gravity.tilt / radians_per_degree)},
          {"map_tilt_sigma_deg", inNineDigits(gravity.tilt_sigma / radians_per_degree)},
          {"up_map", numbers(gravity.up_map)},
          {"accelerometer_bias_mps2", numbers(gravity.bias)},
          {"fused", gravity.fused},
          {"levelled", gravity.levelled}};
}

ReportJson toReportJson(const PriorMapFit& fit)
{
  ReportJson json{{"localised", fit.localised}};
  if (fit.localised)
  {
    json["path_to_localisation_m"] = inNineDigits(fit.path_length);
    json["keyframes"] = fit.tried;
    json["registered"] = fit.registered;
    json["found_again"] = fit.found_again;
    json["rmse_m"] = inNineDigits(fit.rmse);
  }
  else
  {
    json["reason"] = fit.reason;
  }
  return json;
}

ReportJson toReportJson(const PoseOrigin& origin)
{
  return {{"source", toString(origin.source)}, {"name", origin.name}};
}

ReportJson toReportJson(std::size_t count)
{
  return count;
}

ReportJson toReportJson(double value)
{
  return inNineDigits(value);
}

/** An object with the values, each passed through `round`. */
ReportJson toReportJson(const std::map<std::string, double>& values, double (*round)(double))
{
  ReportJson json = ReportJson::object();
  for (const auto& [name, value] : values)
  {
    json[name] = round(value);
  }
  return json;
}

template <typename Value>
void addIfKnown(ReportJson& json, const char* key, const std::optional<Value>& value)
{
  if (value)
  {
    json[key] = toReportJson(*value);
  }
}

std::string dumped(const ReportJson& json, int indent)
{
  return json.dump(indent, ' ', false, ReportJson::error_handler_t::replace);
}

/** The line of the recording in report.json, without indentation. */
std::string inputEntry(const std::string& input)
{
  return "\"input\": " + dumped(input, -1);
}
}  // namespace

std::string runReportText(const RunReport& report)
{
  ReportJson json;
  json["input"] = report.input;
  json["sensor"] = report.sensor;
  addIfKnown(json, "ground_truth", report.ground_truth);
  json["method"] = report.method;
  json["finished"] = report.finished;
  json["ended_early"] = report.ended_early;
  addIfKnown(json, "frames", report.frames);
  addIfKnown(json, "unconverged", report.unconverged);
  addIfKnown(json, "odometry_failed", report.odometry_failed);
  addIfKnown(json, "keyframes", report.keyframes);
  addIfKnown(json, "loops", report.loops);
  addIfKnown(json, "loops_left_out", report.loops_left_out);
  addIfKnown(json, "gnss", report.gnss);
  addIfKnown(json, "gravity", report.gravity);
  addIfKnown(json, "prior_map", report.prior_map);
  addIfKnown(json, "tracks", report.tracks);
  addIfKnown(json, "map_points", report.map_points);
  addIfKnown(json, "path_length_m", report.path_length);
  addIfKnown(json, "ms_per_scan", report.ms_per_scan);
  json["stage_ms"] = toReportJson(report.stage_ms, inNineDigits);
  json["wait_ms"] = toReportJson(report.wait_ms, inNineDigits);
  json["memory_mb"] = toReportJson(report.memory_mb, inTenths);
  addIfKnown(json, "recording_time_s", report.recording_time);
  addIfKnown(json, "run_time_s", report.run_time);
  addIfKnown(json, "realtime_factor", report.realtime_factor);
  json["verdict"] = report.verdict;
  json["failure"] = report.failure;
  json["warnings"] = report.warnings;
  json["not_written"] = report.not_written;
  json["files"] = report.files;
  return dumped(json, 2) + "\n";
}

RunReport parseRunReport(const std::string& text, const std::string& path)
{
  if (isNestedDeeper(text))
  {
    throw UserError(path + ": is nested too deeply for a report");
  }
  const auto json = ReportJson::parse(text, nullptr, false);
  if (!json.is_object())
  {
    throw UserError(path + ": is not the JSON report of a run; repeat the run");
  }
  const auto input = json.find("input");
  if (input != json.end() && !input->is_string() && !input->is_null())
  {
    failOnReport(path, no_recording);
  }
  const ReportFields fields(json, path, "");
  RunReport report;
  report.input = fields.text("input");
  report.sensor = fields.text("sensor");
  report.ground_truth = objectFrom(fields, "ground_truth", poseOriginFrom);
  report.method = fields.text("method");
  report.finished = fields.flag("finished").value_or(true);
  report.ended_early = fields.text("ended_early");
  report.frames = fields.count("frames");
  report.unconverged = fields.count("unconverged");
  report.odometry_failed = fields.count("odometry_failed");
  report.keyframes = fields.count("keyframes");
  report.loops = fields.count("loops");
  report.loops_left_out = fields.count("loops_left_out");
  report.gnss = objectFrom(fields, "gnss", gnssFrom);
  report.gravity = objectFrom(fields, "gravity", gravityFrom);
  report.prior_map = objectFrom(fields, "prior_map", priorMapFrom);
  report.tracks = fields.count("tracks");
  report.map_points = fields.count("map_points");
  report.path_length = fields.number("path_length_m");
  report.ms_per_scan = fields.number("ms_per_scan");
  report.stage_ms = fields.numbers("stage_ms");
  report.wait_ms = fields.numbers("wait_ms");
  report.memory_mb = fields.numbers("memory_mb");
  report.recording_time = fields.number("recording_time_s");
  report.run_time = fields.number("run_time_s");
  report.realtime_factor = fields.number("realtime_factor");
  report.verdict = fields.text("verdict");
  report.failure = fields.text("failure");
  report.warnings = fields.texts("warnings");
  report.not_written = fields.texts("not_written");
  report.files = fields.texts("files");
  return report;
}

std::optional<RunReport> readRunReport(const std::string& folder)
{
  const std::string path = reportPath(folder);
  return std::filesystem::exists(path)
             ? std::optional<RunReport>(parseRunReport(readWhole(path), path))
             : std::nullopt;
}

RunReport runReportIfValid(const std::string& folder)
{
  try
  {
    return readRunReport(folder).value_or(RunReport());
  }
  catch (const UserError&)
  {
    return {};
  }
}

std::string recordingOf(const RunReport& report, const std::string& folder)
{
  if (report.input.empty())
  {
    failOnReport(reportPath(folder), no_recording);
  }
  return recordingOfRun(folder, report.input);
}

void replaceInput(const std::string& folder, const std::string& input)
{
  const std::string path = reportPath(folder);
  std::string text = readWhole(path);
  const std::string before = inputEntry(parseRunReport(text, path).input);
  const std::size_t at = text.find(before);
  if (at != std::string::npos && before != inputEntry(input))
  {
    writeWhole(path, text.replace(at, before.size(), inputEntry(input)));
  }
}
}  // namespace dyslam
