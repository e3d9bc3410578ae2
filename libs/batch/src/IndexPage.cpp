// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/batch/Summary.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
using Json = nlohmann::ordered_json;

constexpr const char* own_style =
    "\n#runs td:first-child { white-space: nowrap; }\n#runs a { color: var(--accent); }\n"
    "#runs span { border-left-style: solid; border-left-width: 4px; padding: 1px 6px; }\n";

/** Relative URL of a file: all characters but letters, digits and a few others are percent-encoded.
 */
std::string address(const std::string& path)
{
  std::string result;
  for (const char c : path)
  {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string("-_./").find(c) != std::string::npos;
    result += plain ? std::string(1, c) : formatted("%%%02X", static_cast<unsigned char>(c));
  }
  return result;
}

std::string numberCell(const std::optional<double>& number, int digits)
{
  return "<td class=\"number\">" + (number ? formatted("%.*f", digits, *number) : "") + "</td>";
}

/** A number of the table, nothing if it is missing. */
std::optional<double> numberAt(const Json& json, const char* pointer)
{
  const Json::json_pointer at(pointer);
  const bool is_number = json.is_object() && json.contains(at) && json.at(at).is_number();
  return is_number ? std::optional<double>(json.at(at).get<double>()) : std::nullopt;
}

/** The entry of each recording in table.json, null without results. table.json has the runs with
 * results in the order of the batch, with the names that dyslam-eval gave them. */
std::vector<Json> errorsOf(const std::vector<BatchResult>& results, const std::string& folder)
{
  std::vector<Json> errors(results.size());
  const fs::path file = fs::path(folder) / "table.json";
  const Json table =
      fs::is_regular_file(file) ? Json::parse(readWhole(file.string()), nullptr, false) : Json();
  const Json runs = table.is_object() ? table.value("runs", Json::array()) : Json::array();
  const auto evaluated = std::count_if(
      results.begin(), results.end(), [](const BatchResult& r) { return r.manifest.hasResults(); });
  if (static_cast<std::size_t>(evaluated) != runs.size())
  {
    return errors;
  }
  auto next = runs.begin();
  for (std::size_t i = 0; i < results.size(); ++i)
  {
    if (results[i].manifest.hasResults())
    {
      errors[i] = *next++;
    }
  }
  return errors;
}

std::string row(const BatchResult& r, const std::string& folder, const Json& errors)
{
  const fs::path results = fs::path(folder) / r.recording.name;
  const RunReport report = runReportIfValid(results.string());
  const Manifest& m = r.manifest;
  const std::string name = escapedHtml(r.recording.name);
  const std::string link = address(r.recording.name);
  const bool has_page = fs::is_regular_file(results / run_files::page);
  std::string html = "<tr><td>";
  html += has_page ? "<a href=\"" + link + "/" + run_files::page + "\">" + name + "</a>" : name;
  const char* mark = m.state == State::done ? "good" : m.hasResults() ? "warn" : "bad";
  html +=
      std::string("</td><td><span class=\"") + mark + "\">" + toString(m.state) + "</span></td>";
  html += numberCell(report.frames, 0) + numberCell(report.path_length, 1) +
          numberCell(report.tracks, 0) + numberCell(report.loops, 0) +
          numberCell(numberAt(errors, "/trajectory/ate/translation_m/rmse"), 3) +
          numberCell(numberAt(errors, "/trajectory/rpe/translation_m/rmse"), 4) +
          numberCell(numberAt(errors, "/segmentation/iou_moving"), 3) +
          numberCell(report.ms_per_scan, 1) + numberCell(m.seconds, 0) +
          numberCell(static_cast<double>(m.peak_memory) / (1U << 30U), 2);
  const std::size_t warnings = report.warnings.size();
  const std::string words =
      m.reason.empty() && warnings > 0 ? counted(warnings, "warning") : m.reason;
  const bool has_log = fs::is_regular_file(results / "log.txt");
  html += "<td class=\"words\">" + escapedHtml(words) +
          (has_log ? " <a href=\"" + link + "/log.txt\">log</a>" : "") + "</td></tr>\n";
  return html;
}
}  // namespace

std::string indexPage(const std::vector<BatchResult>& results,
                      const std::string& folder,
                      const std::string& style)
{
  const std::vector<Json> errors = errorsOf(results, folder);
  const std::string title = escapedHtml(nameOfFile(folder));
  const Counts counts = countsOf(results);
  const bool good = counts.done == results.size();
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
      title + " - DySLAM batch</title>\n<style>\n" + style + own_style +
      "</style>\n</head>\n<body>\n<main>\n<header><h1>" + title + "</h1><p>" +
      counted(results.size(), "recording") +
      ", DySLAM</p></header>\n<section><h2>Runs</h2>\n<div class=\"verdict " +
      (good                              ? "good"
       : counts.failed + counts.open > 0 ? "bad"
                                         : "warn") +
      "\">" + toText(counts) +
      "</div>\n<div class=\"scroll\"><table "
      "id=\"runs\"><thead><tr><th>recording</th><th>state</th>";
  for (const char* column : {"scans", "length [m]", "objects", "loops", "ATE [m]", "RPE [m]", "IoU",
                             "ms/scan", "wall time [s]", "memory [GiB]"})
  {
    html += std::string("<th class=\"number\">") + column + "</th>";
  }
  html += "<th></th></tr></thead>\n<tbody>\n";
  for (std::size_t i = 0; i < results.size(); ++i)
  {
    html += row(results[i], folder, errors[i]);
  }
  html += "</tbody></table></div>\n<p>ATE, RPE and IoU where the recording has ground truth.";
  for (const char* file : {"table.txt", "table.csv", "batch.json"})
  {
    html += fs::is_regular_file(fs::path(folder) / file)
                ? std::string(" <a href=\"") + file + "\">" + file + "</a>"
                : "";
  }
  return html + "</p>\n</section>\n</main>\n</body>\n</html>\n";
}
}  // namespace dyslam::batch
