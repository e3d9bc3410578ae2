// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/JsonText.h>
#include <dyslam/benchmarks/LabelFolders.h>
#include <dyslam/benchmarks/MethodGroups.h>
#include <dyslam/eval/MapMetrics.h>
#include <dyslam/formats/LabelFiles.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** `.label` files by name, in the folder's `labels` or the folder itself. */
std::map<std::string, std::string> labelFiles(const std::string& folder)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": is not a folder");
  }
  const auto labels = labelFolderOf(folder);
  if (!labels)
  {
    throw UserError(folder + ": has no .label files");
  }
  std::map<std::string, std::string> files;
  for (const auto& entry : entriesOf(*labels))
  {
    if (entry.path().extension() == ".label")
    {
      files[entry.path().stem().string()] = entry.path().string();
    }
  }
  return files;
}

/** Instances (not 0) of which a point is labelled moving in any scan. */
std::set<std::uint16_t> movingInstances(const std::map<std::string, std::string>& files)
{
  std::set<std::uint16_t> result;
  for (const auto& [name, path] : files)
  {
    for (const Label label : readLabels(path))
    {
      if (isMovingLabel(label) && instanceOf(label) != 0)
      {
        result.insert(instanceOf(label));
      }
    }
  }
  return result;
}

void addClasses(const std::vector<Label>& labels, LabelClasses& classes)
{
  for (const Label label : labels)
  {
    const std::uint16_t semantic = semanticOf(label);
    if (isMovingLabel(label))
    {
      ++classes.moving;
    }
    else if (classes.unlisted.count(semantic) == 0 && !isSemanticKittiClass(semantic))
    {
      classes.unlisted.insert(semantic);
    }
  }
}

std::vector<Label> readAs(const ReferenceReading& reading,
                          const std::set<std::uint16_t>& movers,
                          std::vector<Label> labels)
{
  for (Label& label : labels)
  {
    const std::uint16_t instance = instanceOf(label);
    if (isIgnoredLabel(label) || instance == 0)
    {
      continue;
    }
    if (reading.standing.count(instance) != 0)
    {
      label =
          makeLabel(isMovingLabel(label) ? semanticOf(label_static) : semanticOf(label), instance);
    }
    else if (movers.count(instance) != 0 && !isMovingLabel(label))
    {
      label = makeLabel(semanticOf(label_moving), instance);
    }
  }
  return labels;
}

/** The folder with the probabilities of an estimate: of a run, or beside its folder `labels`.
 * \param label_file one of its files of labels */
fs::path probabilityFolder(const std::string& estimate, const std::string& label_file)
{
  const fs::path labels = fs::absolute(label_file).lexically_normal().parent_path();
  return (labels.filename() == "labels" ? labels.parent_path() : fs::path(estimate)) /
         "probabilities";
}

/** Reads a file with a float32 per point. \throws UserError for another number of points. */
std::vector<float> readProbabilities(const std::string& path, std::size_t points)
{
  const std::string bytes = readWhole(path);
  if (bytes.size() != points * sizeof(float))
  {
    throw UserError(path + ": has " + counted(bytes.size(), "byte") + " for " +
                    counted(points, "point") +
                    " of 4 bytes; give the labels of the same recording");
  }
  std::vector<float> values(points);
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

TableCell ratioCell(std::optional<double> value)
{
  return {value, 4};
}

struct ScoredScans
{
  std::size_t scans = 0;
  std::size_t of = 0;  //!< number of scans of the reference
  SegmentationScores scores;
};

/** Adds a row to segmentationTable(). */
void addScores(Table& table, const std::string& name, const ScoredScans& scored)
{
  const auto percent = [](std::optional<double> v)
  { return TableCell(v ? std::optional<double>(100 * *v) : std::nullopt, 2); };
  const SegmentationScores& s = scored.scores;
  const std::size_t moving = s.true_positives + s.false_negatives;
  const std::size_t all = moving + s.true_negatives + s.false_positives;
  table.addRow({name, TableCell(static_cast<double>(scored.scans), 0),
                TableCell(static_cast<double>(scored.of), 0), ratioCell(s.iou()),
                ratioCell(s.precision()), ratioCell(s.recall()), ratioCell(s.staticIou()),
                percent(s.staticKept()), percent(s.recall()),
                percent(harmonicMean(s.staticKept(), s.recall())),
                TableCell(static_cast<double>(moving), 0), TableCell(static_cast<double>(all), 0)});
}
}  // namespace

LabelComparison compareLabelFolders(const std::string& reference,
                                    const std::string& estimate,
                                    const ReferenceReading& reading)
{
  const auto reference_files = labelFiles(reference);
  const std::set<std::uint16_t> movers =
      reading.ever_moving ? movingInstances(reference_files) : std::set<std::uint16_t>();
  const auto estimated_files = labelFiles(estimate);
  if (fs::equivalent(fs::path(reference_files.begin()->second).parent_path(),
                     fs::path(estimated_files.begin()->second).parent_path()))
  {
    throw UserError(estimate +
                    ": has the labels of the reference; give the folder of the estimated ones");
  }
  const fs::path probability_folder = probabilityFolder(estimate, estimated_files.begin()->second);
  LabelComparison result;
  result.reference_scans = reference_files.size();
  result.estimated_scans = estimated_files.size();
  for (const auto& [name, path] : reference_files)
  {
    const auto match = estimated_files.find(name);
    if (match != estimated_files.end())
    {
      const std::vector<Label> recorded = readLabels(path);
      const std::vector<Label> estimated = readLabels(match->second, recorded.size());
      addClasses(recorded, result.reference_classes);
      addClasses(estimated, result.estimated_classes);
      const std::vector<Label> labels = readAs(reading, movers, recorded);
      result.evaluator.add(labels, estimated);
      const fs::path probabilities = probability_folder / (name + ".bin");
      if (fs::exists(probabilities))
      {
        result.calibration.add(labels, readProbabilities(probabilities.string(), labels.size()));
      }
    }
  }
  if (result.evaluator.scans() == 0)
  {
    throw UserError(estimate + ": no .label file has the name of one in " + reference + " (" +
                    estimated_files.begin()->first + " and " + reference_files.begin()->first +
                    ", for example); names are the numbers of the scans in the recording, from 0");
  }
  return result;
}

std::string labelWarning(const std::string& reference,
                         const std::string& estimate,
                         const LabelComparison& result)
{
  const auto isStrange = [](const LabelClasses& classes)
  { return classes.moving == 0 && !classes.unlisted.empty(); };
  const bool is_reference = isStrange(result.reference_classes);
  if (!is_reference && !isStrange(result.estimated_classes))
  {
    return "";
  }
  const LabelClasses& classes = is_reference ? result.reference_classes : result.estimated_classes;
  return (is_reference ? reference : estimate) +
         ": no label is of a moving class (251 to 259), and " +
         std::to_string(*classes.unlisted.begin()) +
         " is no class of SemanticKITTI; map the numbers of a learning map to its classes (of "
         "moving object segmentation: 1 to 9, 2 to 251)";
}

std::string partNote(const std::string& reference,
                     const std::string& estimate,
                     const LabelComparison& result)
{
  const std::size_t scans = result.evaluator.scans();
  if (scans == result.reference_scans && scans == result.estimated_scans)
  {
    return "";
  }
  return estimate + " has labels of " + counted(result.estimated_scans, "scan") + ", " + reference +
         " of " + std::to_string(result.reference_scans) + "; the figures are of the " +
         std::to_string(scans) + " that both have";
}

Table segmentationTable(const NamedComparisons& results)
{
  Table table({"estimate", "scans", "of", "IoU moving", "precision", "recall", "IoU static",
               "static kept [%]", "moving removed [%]", "harmonic mean [%]", "moving points",
               "points"});
  for (const auto& [name, r] : results)
  {
    addScores(table, name, {r.evaluator.scans(), r.reference_scans, r.evaluator.scores()});
  }
  return table;
}

std::string addTotalRows(Table& table,
                         const NamedComparisons& results,
                         const std::vector<std::string>& references)
{
  std::vector<std::string> names;
  for (const auto& [name, result] : results)
  {
    names.push_back(name);
  }
  const std::vector<MethodGroup> groups = methodGroups(names, references);
  for (const MethodGroup& group : groups)
  {
    ScoredScans total;
    for (const std::size_t i : group.estimates)
    {
      const LabelComparison& one = results[i].second;
      total.scans += one.evaluator.scans();
      total.of += one.reference_scans;
      total.scores += one.evaluator.scores();
    }
    addScores(table, group.name.empty() ? "all points" : "all points of " + group.name, total);
  }
  return groups.empty() ? "no row of all points, as references are repeated: give the estimates of "
                          "one method after the other, each of the same references and in a folder "
                          "of its own"
                        : "";
}

Table calibrationTable(const CalibrationEvaluator& calibration)
{
  Table table({"probability from", "to", "points", "mean", "share that moves"});
  for (const CalibrationEvaluator::Bin& bin : calibration.bins())
  {
    const auto shown = [&bin](double value)
    { return bin.points > 0 ? TableCell(value, 4) : TableCell(std::nullopt, 4); };
    table.addRow({TableCell(bin.from, 1), TableCell(bin.to, 1),
                  TableCell(static_cast<double>(bin.points), 0), shown(bin.probability),
                  shown(bin.moving)});
  }
  return table;
}

Table classTable(const LabelComparison& result)
{
  Table table({"class", "label", "points", "called moving", "share"});
  for (const auto& [label, scores] : result.evaluator.perClass())
  {
    table.addRow({semanticKittiName(label), TableCell(label, 0),
                  TableCell(static_cast<double>(scores.points), 0),
                  TableCell(static_cast<double>(scores.called_moving), 0),
                  TableCell(static_cast<double>(scores.called_moving) /
                                static_cast<double>(std::max<std::size_t>(scores.points, 1)),
                            4)});
  }
  return table;
}

std::string segmentationJson(const NamedComparisons& results)
{
  nlohmann::ordered_json json;
  json["segmentation"] = nlohmann::ordered_json::array();
  for (const auto& [name, r] : results)
  {
    const SegmentationScores& s = r.evaluator.scores();
    nlohmann::ordered_json entry{
        {"name", name},
        {"scans", r.evaluator.scans()},
        {"reference_scans", r.reference_scans},
        {"iou_moving", orNull(s.iou())},
        {"precision", orNull(s.precision())},
        {"recall", orNull(s.recall())},
        {"iou_static", orNull(s.staticIou())},
        {"static_kept", orNull(s.staticKept())},
        {"moving_removed", orNull(s.recall())},
        {"harmonic_mean", orNull(harmonicMean(s.staticKept(), s.recall()))},
        {"true_positives", s.true_positives},
        {"false_positives", s.false_positives},
        {"false_negatives", s.false_negatives},
        {"true_negatives", s.true_negatives},
        {"ignored", s.ignored}};
    if (r.calibration.points() > 0)
    {
      entry["calibration"] = {{"points", r.calibration.points()},
                              {"expected_error", r.calibration.expectedError()},
                              {"brier_score", r.calibration.brierScore()}};
    }
    for (const auto& [label, scores] : r.evaluator.perClass())
    {
      entry["classes"][semanticKittiName(label)] = {
          {"label", label}, {"points", scores.points}, {"called_moving", scores.called_moving}};
    }
    json["segmentation"].push_back(entry);
  }
  return textOf(json);
}
}  // namespace dyslam
