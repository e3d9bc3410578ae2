// SPDX-License-Identifier: BSD-3-Clause
#include "TracksCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/io/GroundTruth.h>
#include <dyslam/io/KittiFiles.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct Arguments
{
  std::string reference;
  std::string estimate;
  std::string calib;
  std::vector<std::string> types;
  double min_iou = 0.25;
  OutputFlags output;
};

std::vector<LabelledBox> read(const Arguments& a, const std::string& path)
{
  return a.calib.empty() ? readTracks(path)
                         : readKittiTracking(path, readKittiCalib(a.calib).T_cam_velo, true);
}

/** One past the last frame of either file. */
int frameCount(const TrackSequence& sequence)
{
  int last = -1;
  for (const auto* boxes : {&sequence.reference, &sequence.estimate})
  {
    for (const LabelledBox& box : *boxes)
    {
      last = std::max(last, box.frame);
    }
  }
  return last + 1;
}

TrackRules rulesFor(const Arguments& a, const std::string& type)
{
  TrackRules rules = a.calib.empty() ? TrackRules{} : TrackRules::kitti(type);
  rules.type = type;
  rules.min_iou = a.min_iou;
  rules.image_rules = !a.calib.empty();
  rules.switches_across_gaps = a.calib.empty();
  return rules;
}

void run(const Arguments& a)
{
  TrackSequence sequence;
  sequence.reference = read(a, a.reference);
  sequence.estimate = read(a, a.estimate);
  sequence.frames = frameCount(sequence);
  std::vector<std::string> types = a.types;
  if (types.empty())
  {
    std::set<std::string> found;
    for (const LabelledBox& box : sequence.reference)
    {
      if (box.type != "DontCare" && box.id >= 0)
      {
        found.insert(box.type);
      }
    }
    types.assign(found.begin(), found.end());
    if (a.calib.empty())
    {
      types.emplace_back();  // all classes together, whatever each was taken for
    }
  }
  Table table({"class", "boxes", "MOTA", "MOTP", "recall", "precision", "IDS", "FRAG", "FP", "FN",
               "MT", "ML", "HOTA", "DetA", "AssA", "sAMOTA", "AMOTA", "AMOTP"});
  nlohmann::ordered_json json;
  const std::vector<TrackSequence> sequences{sequence};
  for (const std::string& type : types)
  {
    const TrackRules rules = rulesFor(a, type);
    const ClearMot mot = clearMot(sequences, rules);
    const Hota higher_order = hota(sequences, rules);
    const RecallAverages averages = averagesOverRecall(sequences, rules);
    const std::string name = type.empty() ? "all" : type;
    const auto percent = [](double x) { return TableCell(100 * x, 2); };
    // Forty points of recall say nothing about fewer boxes.
    const auto average = [&](double x)
    {
      const bool enough = mot.references >= 40;
      return TableCell(enough ? std::optional<double>(100 * x) : std::nullopt, 2);
    };
    const auto whole = [](std::size_t n) { return TableCell(static_cast<double>(n), 0); };
    table.addRow({name, whole(mot.references), percent(mot.mota), percent(mot.motp),
                  percent(mot.recall), percent(mot.precision), whole(mot.id_switches),
                  whole(mot.fragmentations), whole(mot.false_alarms), whole(mot.misses),
                  percent(mot.mostly_tracked), percent(mot.mostly_lost), percent(higher_order.hota),
                  percent(higher_order.detection), percent(higher_order.association),
                  average(averages.samota), average(averages.amota), average(averages.amotp)});
    json[name] = {{"references", mot.references},
                  {"mota", mot.mota},
                  {"motp", mot.motp},
                  {"recall", mot.recall},
                  {"precision", mot.precision},
                  {"id_switches", mot.id_switches},
                  {"fragmentations", mot.fragmentations},
                  {"false_alarms", mot.false_alarms},
                  {"misses", mot.misses},
                  {"mostly_tracked", mot.mostly_tracked},
                  {"mostly_lost", mot.mostly_lost},
                  {"hota", higher_order.hota},
                  {"deta", higher_order.detection},
                  {"assa", higher_order.association},
                  {"loca", higher_order.localization},
                  {"samota", averages.samota},
                  {"amota", averages.amota},
                  {"amotp", averages.amotp}};
  }
  a.output.put(table, json.dump(2) + "\n");
}
}  // namespace

Subcommand tracksCommand(CLI::App& app)
{
  const auto a = std::make_shared<Arguments>();
  CLI::App* sub = app.add_subcommand(
      "tracks", "Tracked objects against the truth: CLEAR-MOT, HOTA, AB3DMOT's averages");
  sub->add_option("--reference", a->reference,
                  "true tracks (tracks.txt of a run or of a recording's truth)")
      ->required();
  sub->add_option("--estimate", a->estimate, "estimated tracks")->required();
  sub->add_option("--calib", a->calib,
                  "both files are KITTI's own, in the camera's frame: its calibration; the image "
                  "rules of its benchmark apply");
  sub->add_option("--class", a->types, "classes to judge; all of the reference by default");
  sub->add_option("--iou", a->min_iou, "3D overlap of a match")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  a->output.declare(*sub);
  return {sub, [a] { run(*a); }};
}
}  // namespace dyslam
