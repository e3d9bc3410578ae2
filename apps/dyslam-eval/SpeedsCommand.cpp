// SPDX-License-Identifier: BSD-3-Clause
#include "SpeedsCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/benchmarks/KittiSpeeds.h>
#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/plot/LinePlot.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../common/OutputOptions.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct SpeedsArguments
{
  KittiSpeedSources sources;
  std::vector<std::string> series;  // NAME=FILE.csv
  std::string plot;
  OutputFlags output;
};

LineSeries lineOf(const NamedSpeeds& speeds)
{
  LineSeries line{speeds.name, {}};
  for (const auto& [frame, speed] : speeds.speeds)
  {
    line.points.emplace_back(frame * kitti_scan_period, speed);
  }
  return line;
}

/** NAME=FILE.csv \throws UserError. */
std::pair<std::string, std::string> seriesOf(const std::string& given)
{
  const std::size_t equals = given.find('=');
  if (equals == std::string::npos)
  {
    throw UserError("speeds: --series " + given + " must be NAME=FILE.csv");
  }
  return {given.substr(0, equals), given.substr(equals + 1)};
}

void runSpeeds(const SpeedsArguments& a)
{
  KittiSpeedSources sources = a.sources;
  for (const std::string& given : a.series)
  {
    sources.series.push_back(seriesOf(given));
  }
  const std::vector<NamedSpeeds> speeds = kittiSpeeds(sources);
  if (!a.plot.empty())
  {
    std::vector<LineSeries> lines;
    for (const NamedSpeeds& one : speeds)
    {
      lines.push_back(lineOf(one));
    }
    LinePlotOptions options;
    options.title = "Speed of target " + sources.sequence + "/" + std::to_string(sources.track);
    options.x_label = "time [s]";
    options.y_label = "speed [m/s]";
    options.quantile = 0.995;
    writePng(a.plot, renderLinePlot(lines, options));
  }
  const SpeedReport report = speedReport(sources, speeds);
  a.output.write(report.table, report.json);
}
}  // namespace

Subcommand speedsCommand(CLI::App& app)
{
  const auto a = std::make_shared<SpeedsArguments>();
  CLI::App* sub = app.add_subcommand(
      "speeds", "Speed of one car of KITTI tracking over time, from detections and labels");
  sub->add_option("--data", a->sources.data, "folder with label_02, oxts, calib and det_pointrcnn")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("--sequence", a->sources.sequence, "0008, for instance")->required();
  sub->add_option("--track", a->sources.track, "id of the target in the labels")->required();
  sub->add_option("--truth-window", a->sources.truth_window,
                  "labels in the centred quadratic whose slope is the true speed; odd")
      ->check(CLI::Range(3, 101))
      ->check(CLI::Validator([](const std::string& text)
                             { return std::stoi(text) % 2 == 1 ? "" : "must be odd: " + text; },
                             "odd"))
      ->capture_default_str();
  sub->add_option("--series", a->series,
                  "further speeds: NAME=FILE.csv with the columns time (s since the first scan) "
                  "and speed (m/s)");
  addOutputFile(*sub, "--plot", a->plot, "write this PNG");
  a->output.declare(*sub);
  return {sub, [a] { runSpeeds(*a); }};
}
}  // namespace dyslam
