// SPDX-License-Identifier: BSD-3-Clause
#include "TracksCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/eval/TrackMetrics.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrackFiles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../common/Checks.h"
#include "OutputFiles.h"
#include "TrackFiles.h"

namespace dyslam
{
namespace
{
struct TracksArguments
{
  std::string reference;
  std::string estimate;
  std::string calib;
  std::vector<std::string> types;
  double min_iou = 0.25;
  double max_distance = 0;
  TrackSelection selection;
  OutputFlags output;
};

/** Limits of the range intervals of the error table [m]. */
constexpr std::array<double, 4> range_limits{0, 20, 40, 60};

TrackData readFile(const TracksArguments& a, const std::string& path)
{
  return {a.calib.empty() ? readTracks(path)
                          : readKittiTracking(path, readKittiCalib(a.calib).T_cam_velo, true),
          {}};
}

TrackData readReference(const TracksArguments& a, TrackSelection& selection)
{
  if (!std::filesystem::is_directory(a.reference))
  {
    return readFile(a, a.reference);
  }
  TrackData data = readTruth(a.reference, selection);
  if (!a.selection.view && *selection.view < 360)
  {
    std::cout << "true boxes are from camera images: those within " << *selection.view
              << " degrees ahead are evaluated (--view)\n";
  }
  return data;
}

/** Against a ground-truth folder, where it is complete; of a file of true boxes all count. */
TrackData readEstimate(const TracksArguments& a,
                       const TrackData& truth,
                       const TrackSelection& selection)
{
  TrackData data =
      std::filesystem::is_directory(a.estimate) ? readRun(a.estimate) : readFile(a, a.estimate);
  if (std::filesystem::is_directory(a.reference))
  {
    removeUncovered(data.boxes, truth.boxes, selection);
  }
  return data;
}

/** Whether Car, Van, Truck and Bus are one class: in folders, and in a file compared with one. */
bool typesAreMerged(const TracksArguments& a)
{
  return std::filesystem::is_directory(a.reference) || std::filesystem::is_directory(a.estimate);
}

/** Number of frames covered by either file. */
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

/** Removes boxes outside the processed frames. */
void keepFrames(std::vector<LabelledBox>& boxes, const FrameRange& range)
{
  boxes.erase(std::remove_if(boxes.begin(), boxes.end(),
                             [&](const LabelledBox& box)
                             { return box.frame < range.first || box.frame > range.last; }),
              boxes.end());
}

/** Restricts the reference to the frames that the run processed. Scans dropped for their time
 * stamps shift the last frame; the estimated boxes show by how much. */
void keepProcessedFrames(const std::string& folder, TrackSequence& sequence)
{
  auto range = processedFrames(folder);
  if (!range)
  {
    return;
  }
  for (const LabelledBox& box : sequence.estimate)
  {
    range->last = std::max(range->last, box.frame);
  }
  const int all = sequence.frames;
  if (range->first > 0 || range->last + 1 < all)
  {
    std::cout << "frames " << range->first << '-' << range->last << " of " << all << '\n';
    keepFrames(sequence.reference, *range);
  }
}

/** The classes to evaluate, as the boxes name them. \throws UserError for an unknown one. */
std::vector<std::string> classesToEvaluate(const TracksArguments& a, const TrackSequence& sequence)
{
  const bool merged = typesAreMerged(a);
  std::set<std::string> known;
  for (const auto* boxes : {&sequence.reference, &sequence.estimate})
  {
    for (const LabelledBox& box : *boxes)
    {
      if (box.type != "DontCare")
      {
        known.insert(box.type);
      }
    }
  }
  std::set<std::string> words = known;  // accepted names: a merged class has several
  for (const auto c : {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::bus,
                       ObjectClass::motorcyclist, ObjectClass::cyclist, ObjectClass::pedestrian})
  {
    known.insert(merged ? mergedType(toString(c)) : toString(c));
    words.insert(toString(c));
  }
  words.insert(known.begin(), known.end());
  std::vector<std::string> types;
  for (const std::string& word : a.types)
  {
    const auto matches = [&](const std::string& other)
    { return CLI::detail::to_lower(word) == CLI::detail::to_lower(other); };
    if (std::none_of(words.begin(), words.end(), matches))
    {
      std::string all;
      for (const std::string& type : known)
      {
        all += (all.empty() ? "" : ", ") + type;
      }
      const std::string nearest = nearestWord(word, words);
      throw UserError("--class " + word + ": is none of " + all +
                      (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
    }
    const std::string type = merged ? mergedType(word) : word;
    if (std::find(types.begin(), types.end(), type) == types.end())
    {
      types.push_back(type);
    }
  }
  return types;
}

TrackRules rulesFor(const TracksArguments& a, const std::string& type)
{
  TrackRules rules = a.calib.empty() ? TrackRules{} : TrackRules::kitti(type);
  rules.type = type;
  rules.min_iou = a.max_distance > 0 ? 1e-9 : a.min_iou;
  rules.max_distance = a.max_distance;
  rules.image_rules = !a.calib.empty();
  rules.switches_across_gaps = a.calib.empty();
  return rules;
}

nlohmann::ordered_json toJson(const TrackErrorSummary& s)
{
  return {{"boxes", s.boxes},
          {"found", s.found},
          {"same_class", s.same_type},
          {"position_mean", s.position_mean},
          {"position_rmse", s.position_rmse},
          {"yaw_median_deg", s.yaw_median * 180 / M_PI},
          {"speeds", s.speeds},
          {"speed_mean_abs", s.speed_mean_abs},
          {"speed_bias", s.speed_bias}};
}

/** Errors of position, yaw and speed by true class and range, regardless of the estimated class. */
Table errorTable(const std::vector<TrackError>& errors,
                 std::vector<std::string> types,
                 nlohmann::ordered_json& json)
{
  Table table({"class", "range [m]", "boxes", "found %", "same class %", "position [m]", "RMSE [m]",
               "axis [deg]", "speed [m/s]", "bias [m/s]"},
              "Boxes with a track within 2 m: mean position error, median yaw error (axis), mean "
              "|speed error|");
  const auto add = [&](const std::string& type, const std::string& range, double from, double to)
  {
    const TrackErrorSummary s = summaryOf(errors, type, from, to);
    if (s.boxes == 0)
    {
      return;
    }
    const auto known = [](bool any, double x)
    { return any ? std::optional<double>(x) : std::nullopt; };
    const bool any = s.found > 0;
    const double boxes = static_cast<double>(s.boxes);
    const double found = static_cast<double>(s.found);
    const std::string name = type.empty() ? "all" : type;
    table.addRow({name, range, TableCell(boxes, 0), TableCell(100 * found / boxes, 1),
                  TableCell(known(any, 100 * static_cast<double>(s.same_type) / found), 1),
                  TableCell(known(any, s.position_mean), 2),
                  TableCell(known(any, s.position_rmse), 2),
                  TableCell(known(any, s.yaw_median * 180 / M_PI), 1),
                  TableCell(known(s.speeds > 0, s.speed_mean_abs), 2),
                  TableCell(known(s.speeds > 0, s.speed_bias), 2)});
    json[name][range] = toJson(s);
  };
  types.emplace_back();
  for (const std::string& type : types)
  {
    for (std::size_t k = 0; k + 1 < range_limits.size(); ++k)
    {
      add(type,
          std::to_string(static_cast<int>(range_limits[k])) + "-" +
              std::to_string(static_cast<int>(range_limits[k + 1])),
          range_limits[k], range_limits[k + 1]);
    }
    add(type, "all", 0, std::numeric_limits<double>::infinity());
  }
  return table;
}

/** The classes of the reference's counted boxes, and all together for files in the lidar frame. */
std::vector<std::string> defaultClasses(const TracksArguments& a, const TrackSequence& sequence)
{
  std::set<std::string> found;
  for (const LabelledBox& box : sequence.reference)
  {
    if (box.type != "DontCare" && box.id >= 0 && box.occluded != ignored_box)
    {
      found.insert(box.type);
    }
  }
  std::vector<std::string> types(found.begin(), found.end());
  if (a.calib.empty())
  {
    types.emplace_back();  // all classes together, regardless of the estimated class
  }
  return types;
}

/** Adds the metrics of one class to the table and to `json`. */
void addMetrics(const std::string& name,
                const std::vector<TrackSequence>& sequences,
                const TrackRules& rules,
                Table& table,
                nlohmann::ordered_json& json)
{
  const ClearMot mot = clearMot(sequences, rules);
  const Hota higher_order = hota(sequences, rules);
  const RecallAverages averages = averagesOverRecall(sequences, rules);
  const auto percent = [](double x) { return TableCell(100 * x, 2); };
  // Averages over forty recalls require as many boxes.
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
  json = {{"references", mot.references},
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

void runTracks(const TracksArguments& a)
{
  TrackSelection selection = a.selection;
  TrackData truth = readReference(a, selection);
  TrackData estimate = readEstimate(a, truth, selection);
  if (typesAreMerged(a))
  {
    mergeTypes(truth.boxes);
    mergeTypes(estimate.boxes);
  }
  TrackSequence sequence;
  sequence.reference = truth.boxes;
  sequence.estimate = estimate.boxes;
  sequence.frames = frameCount(sequence);
  if (std::filesystem::is_directory(a.estimate))
  {
    keepProcessedFrames(a.estimate, sequence);
  }
  std::vector<std::string> types = classesToEvaluate(a, sequence);
  if (types.empty())
  {
    types = defaultClasses(a, sequence);
  }
  Table table({"class", "boxes", "MOTA", "MOTP", "recall", "precision", "IDS", "FRAG", "FP", "FN",
               "MT", "ML", "HOTA", "DetA", "AssA", "sAMOTA", "AMOTA", "AMOTP"});
  nlohmann::ordered_json json;
  const std::vector<TrackSequence> sequences{sequence};
  for (const std::string& type : types)
  {
    const std::string name = type.empty() ? "all" : type;
    addMetrics(name, sequences, rulesFor(a, type), table, json[name]);
  }
  constexpr double max_distance = 2;  // [m]
  const std::vector<TrackError> errors =
      trackErrors(sequence, rulesFor(a, ""), max_distance, truth.speeds, estimate.speeds);
  types.erase(std::remove(types.begin(), types.end(), ""), types.end());
  const Table by_range = errorTable(errors, types, json["errors"]);
  a.output.write(table, textOf(json));
  std::cout << "\n" << by_range.toText();
}
}  // namespace

Subcommand tracksCommand(CLI::App& app)
{
  const auto a = std::make_shared<TracksArguments>();
  CLI::App* sub = app.add_subcommand(
      "tracks", "Evaluates tracked objects: CLEAR-MOT, HOTA, AB3DMOT's averages");
  sub->add_option("--reference", a->reference,
                  "true tracks: a recording's ground truth (folder x.gt; slow, distant and "
                  "sparsely observed "
                  "boxes are ignored), or a file of tracks, all of which count")
      ->required()
      ->check(CLI::ExistingPath);
  sub->add_option("--estimate", a->estimate, "estimated tracks: a run's folder, or a file")
      ->required()
      ->check(CLI::ExistingPath);
  sub->add_option("--calib", a->calib,
                  "calibration of KITTI files in the camera frame; the image "
                  "rules of its benchmark apply");
  sub->add_option("--class", a->types,
                  "classes to evaluate; all of the reference by default (with a folder: Car, Van, "
                  "Truck and Bus are Vehicle)");
  sub->add_option("--iou", a->min_iou, "least 3D IoU of a match")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  sub->add_option(
         "--distance", a->max_distance,
         "match by the horizontal distance of the centres up to this instead of the IoU, m")
      ->check(CLI::Range(0.01, 100.0));
  sub->add_option("--min-points", a->selection.min_points,
                  "folder x.gt: true boxes with fewer points are ignored")
      ->check(notNegative())
      ->capture_default_str();
  sub->add_option("--min-speed", a->selection.min_speed,
                  "folder x.gt: slower true boxes are ignored, m/s")
      ->check(notNegative())
      ->capture_default_str();
  sub->add_option("--max-range", a->selection.max_range,
                  "folder x.gt: more distant boxes are ignored, m")
      ->check(positive())
      ->capture_default_str();
  sub->add_option(
         "--view", a->selection.view,
         "folder x.gt: evaluated horizontal field of view, centred ahead, degrees; by default 81 "
         "where the true boxes are from KITTI's camera images, else 360")
      ->check(CLI::Range(1.0, 360.0));
  sub->add_option("--first-frame", a->selection.first_frame,
                  "folder x.gt: earlier frames are removed")
      ->check(notNegative())
      ->capture_default_str();
  sub->add_option("--instance-offset", a->selection.instance_offset,
                  "folder x.gt: instance in the labels minus track id; by default 0 or 1, with "
                  "which more boxes have points");
  a->output.declare(*sub);
  return {sub, [a] { runTracks(*a); }};
}
}  // namespace dyslam
