// SPDX-License-Identifier: BSD-3-Clause
#include "SpeedsCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/formats/TextFile.h>
#include <dyslam/plot/LinePlot.h>

#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../common/OutputOptions.h"
#include "KittiTracking.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct SpeedsArguments
{
  std::string data;
  std::string sequence;
  int track = -1;
  int truth_window = 11;
  std::vector<std::string> series;  // NAME=FILE.csv
  std::string plot;
  OutputFlags output;
};

using Speeds = std::map<int, double>;  // by frame [m/s]

/** Speed of a quadratic fitted to the `window` positions around each frame, those of a gap left
 * out: positions by OXTS jump by up to 0.1 m from frame to frame. */
Speeds centredSpeeds(const PlanarTrack& track, int window)
{
  Speeds speeds;
  for (const auto& [frame, position] : track)
  {
    PolynomialOptions options;
    options.degree = 2;
    options.window = window;
    PolynomialTrajectory fit(options);
    const int half = window / 2;
    for (auto at = track.lower_bound(frame - half); at != track.end() && at->first <= frame + half;
         ++at)
    {
      fit.add({at->first * kitti_scan_period, at->second});
    }
    if (static_cast<int>(fit.size()) == window)
    {
      speeds[frame] = fit.predict(frame * kitti_scan_period).velocity.norm();
    }
  }
  return speeds;
}

/** Distance to the previous position over the time between. */
Speeds rawSpeeds(const PlanarTrack& track)
{
  Speeds speeds;
  for (auto at = track.begin(); at != track.end(); ++at)
  {
    if (at != track.begin())
    {
      const auto before = std::prev(at);
      speeds[at->first] =
          (at->second - before->second).norm() / ((at->first - before->first) * kitti_scan_period);
    }
  }
  return speeds;
}

/** Speed of a causal motion model after each observation. */
template <typename Model>
Speeds causalSpeeds(const PlanarTrack& track, Model model)
{
  Speeds speeds;
  for (const auto& [frame, position] : track)
  {
    model.add({frame * kitti_scan_period, position});
    const MotionPrediction now = model.predict(frame * kitti_scan_period);
    if (now.samples > 2)
    {
      speeds[frame] = now.velocity.norm();
    }
  }
  return speeds;
}

/** A CSV file with a header and the columns time [s since the first scan] and speed [m/s]. */
Speeds readSpeeds(const std::string& path)
{
  TextFile file(path, ",\r");
  if (!file.next() || file.fields().size() != 2 || file.fields()[0] != "time" ||
      file.fields()[1] != "speed")
  {
    throw UserError(path + ": the first line must be time,speed");
  }
  Speeds speeds;
  while (file.next())
  {
    file.requireFields(2, "time,speed");
    speeds[static_cast<int>(std::lround(file.number(0) / kitti_scan_period))] = file.number(1);
  }
  return speeds;
}

struct SpeedError
{
  double rmse = 0;  //!< [m/s]; NaN without a frame
  int frames = 0;   //!< with both speeds
};

SpeedError speedError(const Speeds& speeds, const Speeds& truth)
{
  double sum = 0;
  int count = 0;
  for (const auto& [frame, speed] : speeds)
  {
    if (const auto at = truth.find(frame); at != truth.end())
    {
      sum += (speed - at->second) * (speed - at->second);
      ++count;
    }
  }
  return {count > 0 ? std::sqrt(sum / count) : std::nan(""), count};
}

LineSeries lineOf(const std::string& name, const Speeds& speeds)
{
  LineSeries line{name, {}};
  for (const auto& [frame, speed] : speeds)
  {
    line.points.emplace_back(frame * kitti_scan_period, speed);
  }
  return line;
}

std::vector<std::pair<std::string, Speeds>> allSpeeds(const SpeedsArguments& a, const Speeds& truth)
{
  const std::string file = "/" + a.sequence + ".txt";
  const KittiTarget target =
      readKittiTarget(a.data + "/label_02" + file, a.data + "/oxts" + file,
                      a.data + "/calib" + file, a.track, a.data + "/det_pointrcnn/Car" + file);
  PolynomialOptions quadratic;  // the paper's degree and window
  std::vector<std::pair<std::string, Speeds>> all{
      {"raw differences", rawSpeeds(target.observations)},
      {"causal quadratic, 30 detections",
       causalSpeeds(target.observations, PolynomialTrajectory(quadratic))},
      {"causal, adaptive", causalSpeeds(target.observations, AdaptivePredictor())}};
  for (const std::string& given : a.series)
  {
    const std::size_t equals = given.find('=');
    if (equals == std::string::npos)
    {
      throw UserError("speeds: --series " + given + " must be NAME=FILE.csv");
    }
    all.emplace_back(given.substr(0, equals), readSpeeds(given.substr(equals + 1)));
  }
  all.emplace_back("labels", truth);
  return all;
}

void runSpeeds(const SpeedsArguments& a)
{
  const std::string file = "/" + a.sequence + ".txt";
  const KittiTarget labels = readKittiTarget(a.data + "/label_02" + file, a.data + "/oxts" + file,
                                             a.data + "/calib" + file, a.track, "");
  const Speeds truth = centredSpeeds(labels.truth, a.truth_window);
  Table table({"speed from", "RMSE [m/s]", "frames"},
              "sequence " + a.sequence + ", track " + std::to_string(a.track));
  nlohmann::ordered_json json;
  std::vector<LineSeries> lines;
  for (const auto& [name, speeds] : allSpeeds(a, truth))
  {
    lines.push_back(lineOf(name, speeds));
    if (name != "labels")
    {
      const SpeedError error = speedError(speeds, truth);
      table.addRow({name, TableCell(error.rmse, 3), TableCell(error.frames, 0)});
      json[name] = error.rmse;
    }
  }
  if (!a.plot.empty())
  {
    LinePlotOptions options;
    options.title = "Speed of target " + a.sequence + "/" + std::to_string(a.track);
    options.x_label = "time [s]";
    options.y_label = "speed [m/s]";
    options.quantile = 0.995;
    writePng(a.plot, renderLinePlot(lines, options));
  }
  a.output.write(table, textOf(json));
}
}  // namespace

Subcommand speedsCommand(CLI::App& app)
{
  const auto a = std::make_shared<SpeedsArguments>();
  CLI::App* sub = app.add_subcommand(
      "speeds", "Speed of one car of KITTI tracking over time, from detections and labels");
  sub->add_option("--data", a->data, "folder with label_02, oxts, calib and det_pointrcnn")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("--sequence", a->sequence, "0008, for instance")->required();
  sub->add_option("--track", a->track, "id of the target in the labels")->required();
  sub->add_option("--truth-window", a->truth_window,
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
