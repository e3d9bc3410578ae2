// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/TrackComparison.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrackFiles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

namespace dyslam
{
namespace
{
/** Limits of the range intervals of the error table [m]. */
constexpr std::array<double, 4> range_limits{0, 20, 40, 60};

/** Requires that no two boxes of a frame have the same id, as the metrics do. \param of_classes
 * classes are evaluated one by one, each with its own ids \throws UserError. */
void requireUniqueIds(const std::vector<LabelledBox>& boxes,
                      bool of_classes,
                      const std::string& path)
{
  std::set<std::tuple<int, int, std::string>> seen;
  for (const LabelledBox& box : boxes)
  {
    if (box.id >= 0 && !seen.emplace(box.frame, box.id, of_classes ? lowered(box.type) : "").second)
    {
      throw UserError(path + ": two boxes of frame " + std::to_string(box.frame) + " have the id " +
                      std::to_string(box.id) + "; give each object an id of its own");
    }
  }
}

TrackData readTrackFile(const TrackSources& sources, const std::string& path)
{
  const bool of_kitti = !sources.calib.empty();
  TrackData data;
  data.boxes = of_kitti ? readKittiTracking(path, readKittiCalib(sources.calib).T_cam_velo, true)
                        : readTracks(path);
  requireUniqueIds(data.boxes, of_kitti, path);
  return data;
}

/** \throws UserError also for boxes that belong to no track. */
TrackData readEstimateFile(const TrackSources& sources)
{
  TrackData data = readTrackFile(sources, sources.estimate);
  for (const LabelledBox& box : data.boxes)
  {
    if (box.id < 0 && lowered(box.type) != "dontcare")
    {
      throw UserError(sources.estimate + ": a box of frame " + std::to_string(box.frame) +
                      " has the id " + std::to_string(box.id) +
                      "; the ids of tracks begin at 0, and detections without tracks cannot be "
                      "evaluated");
    }
  }
  return data;
}

/** Requires rectangles in the image: without them KITTI's image rules ignore every false alarm.
 * \throws UserError. */
void requireRectangles(const std::vector<LabelledBox>& boxes, const std::string& path)
{
  if (!boxes.empty() && std::all_of(boxes.begin(), boxes.end(),
                                    [](const LabelledBox& box) { return box.image_box.isZero(); }))
  {
    throw UserError(path +
                    ": its boxes have no rectangles in the image, which --calib needs; give KITTI "
                    "result files with them, or tracks in the lidar frame without --calib");
  }
}

/** Whether most boxes are higher above the lidar than what moves on the ground. */
bool areMostlyInTheAir(const std::vector<LabelledBox>& boxes)
{
  constexpr double highest = 5;  // above the lidar [m]
  std::size_t all = 0;
  std::size_t high = 0;
  for (const LabelledBox& box : boxes)
  {
    const bool counts = lowered(box.type) != "dontcare";
    all += counts ? 1 : 0;
    high += counts && box.box.centre.z() > highest ? 1 : 0;
  }
  return 2 * high > all;
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

/** The classes named by the user, as the boxes name them. \throws UserError for an unknown class.
 */
std::vector<std::string> givenClasses(const TrackSources& sources,
                                      const TrackSequence& sequence,
                                      const std::vector<std::string>& words_given)
{
  const bool merged = typesAreMerged(sources);
  std::set<std::string> known;  // a merged class has several names
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
  for (const auto c : {ObjectClass::car, ObjectClass::van, ObjectClass::truck, ObjectClass::bus,
                       ObjectClass::motorcyclist, ObjectClass::cyclist, ObjectClass::pedestrian})
  {
    known.insert(toString(c));
    known.insert(merged ? mergedType(toString(c)) : toString(c));
  }
  std::vector<std::string> types;
  for (const std::string& word : words_given)
  {
    const auto matches = [&](const std::string& other) { return lowered(word) == lowered(other); };
    if (std::none_of(known.begin(), known.end(), matches))
    {
      throw UserError("--class: " + unknownWord("class", word, known));
    }
    const std::string type = merged ? mergedType(word) : word;
    if (std::find(types.begin(), types.end(), type) == types.end())
    {
      types.push_back(type);
    }
  }
  return types;
}

TrackRules rulesFor(const TrackSources& sources,
                    const TrackMatching& matching,
                    const std::string& type)
{
  TrackRules rules = sources.calib.empty() ? TrackRules{} : TrackRules::kitti(type);
  rules.type = type;
  rules.min_iou = matching.max_distance > 0 ? 1e-9 : matching.min_iou;
  rules.max_distance = matching.max_distance;
  rules.image_rules = !sources.calib.empty();
  rules.switches_across_gaps = sources.calib.empty();
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

/** Errors of position, yaw and speed by true class and range, regardless of the estimated class.
 * \param types classes, each with rows of its own; "": all errors together */
Table errorTable(const std::vector<TrackError>& errors,
                 const std::vector<std::string>& types,
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
    const double boxes = static_cast<double>(s.boxes);
    const double found = static_cast<double>(s.found);
    const std::string name = type.empty() ? "all" : type;
    table.addRow({name, range, TableCell(boxes, 0), TableCell(100 * found / boxes, 1),
                  TableCell(100 * static_cast<double>(s.same_type) / found, 1),
                  TableCell(s.position_mean, 2), TableCell(s.position_rmse, 2),
                  TableCell(s.yaw_median * 180 / M_PI, 1), TableCell(s.speed_mean_abs, 2),
                  TableCell(s.speed_bias, 2)});
    json[name][range] = toJson(s);
  };
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

/** Removes the errors of boxes of other classes. */
void keepClasses(std::vector<TrackError>& errors, const std::vector<std::string>& types)
{
  const auto isOther = [&](const TrackError& error)
  {
    return std::none_of(types.begin(), types.end(),
                        [&](const std::string& type)
                        { return lowered(type) == lowered(error.type); });
  };
  errors.erase(std::remove_if(errors.begin(), errors.end(), isOther), errors.end());
}

/** The classes of the reference's counted boxes, and all together for files in the lidar frame. */
std::vector<std::string> defaultClasses(const TrackSources& sources, const TrackSequence& sequence)
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
  if (sources.calib.empty())
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
  const auto whole = [](std::size_t n) { return TableCell(static_cast<double>(n), 0); };
  table.addRow({name, whole(mot.references), percent(mot.mota), percent(mot.motp),
                percent(mot.recall), percent(mot.precision), whole(mot.id_switches),
                whole(mot.fragmentations), whole(mot.false_alarms), whole(mot.misses),
                percent(mot.mostly_tracked), percent(mot.mostly_lost), percent(higher_order.hota),
                percent(higher_order.detection), percent(higher_order.association),
                percent(averages.samota), percent(averages.amota), percent(averages.amotp)});
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
}  // namespace

TrackData readReferenceTracks(const TrackSources& sources,
                              TrackSelection& selection,
                              const NoteSink& note)
{
  return std::filesystem::is_directory(sources.reference)
             ? readTruth(sources.reference, selection, note)
             : readTrackFile(sources, sources.reference);
}

TrackData readEstimatedTracks(const TrackSources& sources,
                              const TrackData& truth,
                              const TrackSelection& selection)
{
  TrackData data = std::filesystem::is_directory(sources.estimate) ? readRun(sources.estimate)
                                                                   : readEstimateFile(sources);
  if (!sources.calib.empty())
  {
    requireRectangles(data.boxes, sources.estimate);
  }
  if (std::filesystem::is_directory(sources.reference))
  {
    removeUncovered(data.boxes, truth, selection);
  }
  return data;
}

std::string boxFrameWarning(const TrackSources& sources,
                            const TrackData& truth,
                            const TrackData& estimate)
{
  if (!sources.calib.empty())
  {
    return "";
  }
  const bool is_truth = areMostlyInTheAir(truth.boxes);
  if (!is_truth && !areMostlyInTheAir(estimate.boxes))
  {
    return "";
  }
  return (is_truth ? sources.reference : sources.estimate) +
         ": most boxes are more than 5 m above the lidar, as those in KITTI's camera frame (z "
         "ahead) seem without --calib; give it, with both files in that frame";
}

bool typesAreMerged(const TrackSources& sources)
{
  return std::filesystem::is_directory(sources.reference) ||
         std::filesystem::is_directory(sources.estimate);
}

TrackSequence sequenceOf(const TrackSources& sources,
                         const TrackData& truth,
                         const TrackData& estimate)
{
  TrackSequence sequence;
  sequence.reference = truth.boxes;
  sequence.estimate = estimate.boxes;
  if (typesAreMerged(sources))
  {
    mergeTypes(sequence.reference);
    mergeTypes(sequence.estimate);
  }
  sequence.frames = frameCount(sequence);
  return sequence;
}

std::optional<FrameRange> keepProcessedFrames(const TrackSources& sources, TrackSequence& sequence)
{
  auto range = std::filesystem::is_directory(sources.estimate) ? processedFrames(sources.estimate)
                                                               : std::nullopt;
  if (!range)
  {
    return std::nullopt;
  }
  for (const LabelledBox& box : sequence.estimate)
  {
    range->last = std::max(range->last, box.frame);
  }
  if (range->first <= 0 && range->last + 1 >= sequence.frames)
  {
    return std::nullopt;
  }
  keepFrames(sequence.reference, *range);
  return range;
}

std::vector<std::string> trackClasses(const TrackSources& sources,
                                      const TrackSequence& sequence,
                                      const std::vector<std::string>& given)
{
  const std::vector<std::string> types = givenClasses(sources, sequence, given);
  return types.empty() ? defaultClasses(sources, sequence) : types;
}

TrackReport evaluateTracks(const TrackSources& sources,
                           const TrackMatching& matching,
                           const TrackSequence& sequence,
                           std::vector<std::string> types,
                           const TrackSpeeds& true_speeds,
                           const TrackSpeeds& estimated_speeds)
{
  Table table({"class", "boxes", "MOTA", "MOTP", "recall", "precision", "IDS", "FRAG", "FP", "FN",
               "MT", "ML", "HOTA", "DetA", "AssA", "sAMOTA", "AMOTA", "AMOTP"});
  nlohmann::ordered_json json;
  const std::vector<TrackSequence> sequences{sequence};
  for (const std::string& type : types)
  {
    const std::string name = type.empty() ? "all" : type;
    addMetrics(name, sequences, rulesFor(sources, matching, type), table, json[name]);
  }
  constexpr double max_distance = 2;  // [m]
  std::vector<TrackError> errors = trackErrors(sequence, rulesFor(sources, matching, ""),
                                               max_distance, true_speeds, estimated_speeds);
  const bool has_all = std::find(types.begin(), types.end(), "") != types.end();
  if (!has_all)
  {
    keepClasses(errors, types);
    if (types.size() > 1)
    {
      types.emplace_back();
    }
  }
  const Table by_range = errorTable(errors, types, json["errors"]);
  return {table, by_range, textOf(json)};
}
}  // namespace dyslam
