// SPDX-License-Identifier: BSD-3-Clause
#include "KittiMotCommand.h"

#include <dyslam/core/Options.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/eval/TrackMetrics.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "KittiTracking.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct Arguments
{
  std::string data;
  std::string config = "kitti_mot.ini";
  std::string split = "validation";
  std::vector<std::string> types{"Car", "Pedestrian", "Cyclist"};
  std::vector<std::string> set;
  double min_iou = 0.25;
  int repeats = 3;
  OutputFlags output;
};

/** Published figures of AB3DMOT (PointRCNN, validation sequences, IoU 0.25), in percent. */
struct Published
{
  const char* type;
  double samota;
  double mota;
  double motp;
  double frames_per_second;
};
constexpr Published ab3dmot[] = {{"Car", 93.34, 86.47, 79.40, 108.7},
                                 {"Pedestrian", 82.73, 73.86, 67.58, 119.2},
                                 {"Cyclist", 93.78, 84.79, 77.23, 980.7}};

const Published* publishedFor(const Arguments& a, const std::string& type)
{
  if (a.split != "validation" || a.min_iou != 0.25)
  {
    return nullptr;
  }
  const auto* found = std::find_if(std::begin(ab3dmot), std::end(ab3dmot),
                                   [&](const Published& p) { return type == p.type; });
  return found == std::end(ab3dmot) ? nullptr : found;
}

TrackerOptions optionsOf(const Arguments& a)
{
  Config config = Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini"));
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  ConfigLoader loader(config);
  TrackerOptions options = loader.get<TrackerOptions>("tracker");
  loader.requireAllUsed();
  return options;
}

void run(const Arguments& a)
{
  const TrackerOptions options = optionsOf(a);
  const std::vector<std::string> names =
      a.split == "validation" ? kittiMotValidation() : kittiMotTraining();
  Table table({"class", "tracker", "sAMOTA", "AMOTA", "AMOTP", "MOTA", "MOTP", "IDS", "FRAG", "FP",
               "FN", "HOTA", "AssA", "frames/s"},
              "3D tracking of PointRCNN detections, KITTI " + a.split + " sequences");
  nlohmann::ordered_json json;
  for (const std::string& type : a.types)
  {
    KittiMotRun tracked;
    double seconds = std::numeric_limits<double>::infinity();
    for (int i = 0; i < a.repeats; ++i)
    {
      tracked = runKittiMot(a.data, names, type, options);
      seconds = std::min(seconds, tracked.seconds);
    }
    TrackRules rules = TrackRules::kitti(type);
    rules.min_iou = a.min_iou;
    const RecallAverages averages = averagesOverRecall(tracked.sequences, rules);
    const Hota higher_order = hota(tracksAbove(tracked.sequences, averages.best.threshold), rules);
    const ClearMot& best = averages.best;
    const double speed = tracked.frames / seconds;
    const auto percent = [](double x) { return TableCell(100 * x, 2); };
    const auto whole = [](std::size_t n) { return TableCell(static_cast<double>(n), 0); };
    table.addRow({type, "ours", percent(averages.samota), percent(averages.amota),
                  percent(averages.amotp), percent(best.mota), percent(best.motp),
                  whole(best.id_switches), whole(best.fragmentations), whole(best.false_alarms),
                  whole(best.misses), percent(higher_order.hota), percent(higher_order.association),
                  TableCell(speed, 0)});
    if (const Published* p = publishedFor(a, type))
    {
      table.addRow({type, "AB3DMOT, published", TableCell(p->samota, 2), "-", "-",
                    TableCell(p->mota, 2), TableCell(p->motp, 2), "-", "-", "-", "-", "-", "-",
                    TableCell(p->frames_per_second, 1)});
    }
    json[type] = {{"samota", averages.samota},
                  {"amota", averages.amota},
                  {"amotp", averages.amotp},
                  {"mota", best.mota},
                  {"motp", best.motp},
                  {"id_switches", best.id_switches},
                  {"fragmentations", best.fragmentations},
                  {"false_alarms", best.false_alarms},
                  {"misses", best.misses},
                  {"references", best.references},
                  {"hota", higher_order.hota},
                  {"deta", higher_order.detection},
                  {"assa", higher_order.association},
                  {"frames", tracked.frames},
                  {"frames_per_second", speed}};
  }
  a.output.write(table, json.dump(2) + "\n");
}
}  // namespace

Subcommand kittiMotCommand(CLI::App& app)
{
  const auto a = std::make_shared<Arguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-mot",
      "Evaluates the tracker on KITTI tracking with PointRCNN detections, next to "
      "AB3DMOT's published figures");
  sub->add_option("--data", a->data, "folder with label_02, oxts, calib and det_pointrcnn")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with the section [tracker]")
      ->capture_default_str();
  sub->add_option("--set", a->set, "tracker.key=value, overrides the ini");
  sub->add_option("--split", a->split, "AB3DMOT's validation sequences, or the others")
      ->check(CLI::IsMember({"validation", "training"}))
      ->capture_default_str();
  sub->add_option("--class", a->types, "classes to track")
      ->check(CLI::IsMember({"Car", "Pedestrian", "Cyclist"}))
      ->capture_default_str();
  sub->add_option("--iou", a->min_iou, "3D overlap of a match")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option("--repeats", a->repeats, "number of runs; the speed is that of the fastest")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  a->output.declare(*sub);
  return {sub, [a] { run(*a); }};
}
}  // namespace dyslam
