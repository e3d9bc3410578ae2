// SPDX-License-Identifier: BSD-3-Clause
#include "KittiMotCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Options.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/eval/TrackMetrics.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../common/OutputOptions.h"
#include "KittiMot.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct KittiMotArguments
{
  std::string config = "kitti_mot.ini";
  std::string split = "validation";
  std::vector<std::string> sequences;
  std::vector<std::string> types{"Car", "Pedestrian", "Cyclist"};
  std::vector<std::string> set;
  KittiMotSetup setup;
  std::string tracks;
  double min_iou = 0.25;
  int repeats = 3;
  OutputFlags output;
};

/** Figures of AB3DMOT (PointRCNN, validation sequences, IoU 0.25), in percent. */
struct Published
{
  const char* type;
  double samota;
  double mota;
  double motp;
  double frames_per_second;
  // Scored as ours: its script loses tracks whose score equals a threshold to rounding.
  double rescored_samota;
  double rescored_mota;
};
constexpr Published ab3dmot[] = {{"Car", 93.34, 86.47, 79.40, 108.7, 93.55, 87.04},
                                 {"Pedestrian", 82.73, 73.86, 67.58, 119.2, 83.24, 73.86},
                                 {"Cyclist", 93.78, 84.79, 77.23, 980.7, 95.59, 84.79}};

/** Nothing unless the detections are PointRCNN's, whole and as AB3DMOT used them. */
const Published* publishedFor(const KittiMotArguments& a, const std::string& type)
{
  if (a.split != "validation" || !a.sequences.empty() || a.min_iou != 0.25 ||
      !a.setup.detections.empty() || a.setup.added_noise > 0 || a.setup.every > 1)
  {
    return nullptr;
  }
  const auto* found = std::find_if(std::begin(ab3dmot), std::end(ab3dmot),
                                   [&](const Published& p) { return type == p.type; });
  return found == std::end(ab3dmot) ? nullptr : found;
}

KittiMotSetup setupOf(const KittiMotArguments& a)
{
  Config config =
      Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam-eval"));
  config.requireFor("dyslam-eval");
  for (const std::string& assignment : a.set)
  {
    config.set(assignment);
  }
  ConfigLoader loader(config);
  KittiMotSetup setup = a.setup;
  setup.tracker = loader.get<TrackerOptions>("tracker");
  setup.noise = loader.get<DetectionNoiseOptions>("detection_noise");
  loader.requireAllUsed();
  if (setup.detections.empty())
  {
    setup.detections = setup.data + "/det_pointrcnn";
  }
  return setup;
}

/** \throws UserError if the files of --tracks would replace files that are read. */
void requireTracksApart(const KittiMotArguments& a, const KittiMotSetup& setup)
{
  std::vector<std::string> read{setup.detections};
  for (const std::string& type : a.types)
  {
    read.push_back(setup.detections + "/" + type);
  }
  for (const char* part : {"/label_02", "/oxts", "/calib", "/times"})
  {
    read.push_back(setup.data + part);
  }
  for (const std::string& folder : read)
  {
    if (isSamePath(a.tracks, folder))
    {
      throw UserError(a.tracks + ": has the files that are read; choose another --tracks");
    }
  }
}

struct Scores
{
  RecallAverages averages;
  Hota higher_order;
  double frames_per_second = 0;
};

void addRows(const KittiMotArguments& a,
             const std::string& type,
             const Scores& scores,
             Table& table)
{
  const RecallAverages& averages = scores.averages;
  const ClearMot& best = averages.best;
  const auto percent = [](double x) { return TableCell(100 * x, 2); };
  const auto whole = [](std::size_t n) { return TableCell(static_cast<double>(n), 0); };
  table.addRow({type, "ours", percent(averages.samota), percent(averages.amota),
                percent(averages.amotp), percent(best.mota), percent(best.motp),
                whole(best.id_switches), whole(best.fragmentations), whole(best.false_alarms),
                whole(best.misses), percent(scores.higher_order.hota),
                percent(scores.higher_order.association), TableCell(scores.frames_per_second, 0)});
  if (const Published* p = publishedFor(a, type))
  {
    table.addRow({type, "AB3DMOT, published", TableCell(p->samota, 2), "-", "-",
                  TableCell(p->mota, 2), TableCell(p->motp, 2), "-", "-", "-", "-", "-", "-",
                  TableCell(p->frames_per_second, 1)});
    table.addRow({type, "AB3DMOT, scored alike", TableCell(p->rescored_samota, 2), "-", "-",
                  TableCell(p->rescored_mota, 2), "-", "-", "-", "-", "-", "-", "-", "-"});
  }
}

nlohmann::ordered_json toJson(const Scores& scores, int frames)
{
  const RecallAverages& averages = scores.averages;
  const ClearMot& best = averages.best;
  return {{"samota", averages.samota},
          {"amota", averages.amota},
          {"amotp", averages.amotp},
          {"mota", best.mota},
          {"motp", best.motp},
          {"id_switches", best.id_switches},
          {"fragmentations", best.fragmentations},
          {"false_alarms", best.false_alarms},
          {"misses", best.misses},
          {"references", best.references},
          {"hota", scores.higher_order.hota},
          {"deta", scores.higher_order.detection},
          {"assa", scores.higher_order.association},
          {"frames", frames},
          {"frames_per_second", scores.frames_per_second}};
}

void runKittiMot(const KittiMotArguments& a)
{
  const KittiMotSetup setup = setupOf(a);
  requireTracksApart(a, setup);
  const std::vector<std::string> names = !a.sequences.empty()      ? a.sequences
                                         : a.split == "validation" ? kittiMotValidation()
                                                                   : kittiMotTraining();
  Table table({"class", "tracker", "sAMOTA", "AMOTA", "AMOTP", "MOTA", "MOTP", "IDS", "FRAG", "FP",
               "FN", "HOTA", "AssA", "frames/s"},
              "3D tracking of given detections, KITTI " +
                  (a.sequences.empty() ? a.split : std::string("chosen")) + " sequences");
  nlohmann::ordered_json json;
  std::vector<KittiMotRun> runs;
  for (const std::string& type : a.types)
  {
    runs.emplace_back();
    double seconds = std::numeric_limits<double>::infinity();
    for (int i = 0; i < a.repeats; ++i)
    {
      runs.back() = runKittiMot(setup, names, type);
      seconds = std::min(seconds, runs.back().seconds);
    }
    TrackRules rules = TrackRules::kitti(type);
    rules.min_iou = a.min_iou;
    const std::vector<TrackSequence>& sequences = runs.back().sequences;
    Scores scores;
    scores.averages = averagesOverRecall(sequences, rules);
    scores.higher_order = hota(tracksAbove(sequences, scores.averages.best.threshold), rules);
    scores.frames_per_second = runs.back().frames / seconds;
    addRows(a, type, scores, table);
    json[type] = toJson(scores, runs.back().frames);
  }
  if (!a.tracks.empty())
  {
    writeKittiMot(a.tracks, setup.data, names, runs);
  }
  a.output.write(table, textOf(json));
}
}  // namespace

Subcommand kittiMotCommand(CLI::App& app)
{
  const auto a = std::make_shared<KittiMotArguments>();
  CLI::App* sub = app.add_subcommand(
      "kitti-mot",
      "Evaluates the tracker on KITTI tracking with given detections, next to AB3DMOT's figures");
  sub->add_option("--data", a->setup.data, "folder with label_02, oxts and calib")
      ->required()
      ->check(CLI::ExistingDirectory);
  sub->add_option("--detections", a->setup.detections,
                  "folder of detections (NNNN.txt, or such a folder for each class) as AB3DMOT's "
                  "csv or KITTI's tracking columns with a score; default det_pointrcnn in --data")
      ->check(CLI::ExistingDirectory);
  sub->add_option("-c,--config", a->config, "ini with the sections [tracker], [detection_noise]")
      ->capture_default_str();
  sub->add_option("--set", a->set, "one setting, overrides the ini")
      ->type_name("SECTION.KEY=VALUE");
  sub->add_option("--split", a->split, "AB3DMOT's validation sequences, or the others")
      ->check(CLI::IsMember({"validation", "training"}))
      ->capture_default_str();
  sub->add_option("--sequences", a->sequences, "these sequences (0000 ...) instead of the split");
  sub->add_option("--class", a->types, "classes to track")
      ->check(CLI::IsMember({"Car", "Pedestrian", "Cyclist"}))
      ->capture_default_str();
  sub->add_option("--iou", a->min_iou, "3D overlap of a match")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option("--repeats", a->repeats, "number of runs; the speed is that of the fastest")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  sub->add_option("--dt", a->setup.frame_time,
                  "time between scans of sequences without times/NNNN.txt, s")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  sub->add_flag("--deskew,!--no-deskew", a->setup.deskew,
                "boxes and labels are of scans that are not deskewed, as KITTI's (default)");
  sub->add_option("--noise", a->setup.added_noise,
                  "standard deviation of noise added to x and y of the detections, m")
      ->check(CLI::Range(0.0, 10.0));
  sub->add_option("--seed", a->setup.seed, "seed of the added noise")->capture_default_str();
  sub->add_option("--every", a->setup.every, "use and evaluate only every n-th frame")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  addOutputFolder(*sub, "--tracks", a->tracks,
                  "write KITTI result files to this folder (NNNN.txt, all classes)");
  a->output.declare(*sub);
  return {sub, [a] { runKittiMot(*a); }};
}
}  // namespace dyslam
