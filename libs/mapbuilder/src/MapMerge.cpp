// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/ScanReading.h>
#include <dyslam/mrpt/Geodesy.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "MapPictures.h"
#include "MapWriting.h"
#include "MergeTable.h"
#include "RunMerging.h"

namespace dyslam
{
namespace
{
/** What was found of a run that is not joined, and what is needed. */
std::string reasonOf(const JoinEvidence& evidence)
{
  const std::string needed = std::to_string(evidence.needed);
  if (!evidence.placed)
  {
    return counted(evidence.loops, "loop") + " found, " + needed +
           " that agree with each other are needed, about 12 m of common path";
  }
  const auto percent = static_cast<int>(std::lround(100 * evidence.min_confirmed));
  return counted(evidence.loops, "loop") + " found, but the rest of the path contradicts them: " +
         std::to_string(evidence.confirmed) + " of " + counted(evidence.tried, "keyframe") +
         " confirmed, " + std::to_string(percent) + " % are needed (merge.min_confirmed); " +
         counted(evidence.consistent, "consistent loop") + ", " + needed + " are needed";
}

/** "monday: loops place it 48.2 m from where its satellite positions do, by those of tuesday ..."
 */
std::string contradictionOf(const RunFolder& run,
                            const RunFolder& other,
                            const GnssContradiction& contradiction)
{
  return run.folder +
         formatted(": loops place it %.1f m from where its satellite positions do, by those of ",
                   contradiction.distance) +
         other.folder + formatted(" (%.1f m are tolerated); ", contradiction.tolerated) +
         "the place looks like another, or positions are wrong: --set merge.gnss=false merges "
         "without them";
}

/** Distance of a run from the others by satellite positions, if they do not overlap. */
std::string distanceOf(const JoinEvidence& evidence)
{
  constexpr double least = 10;  // shorter distances do not tell why [m]
  return evidence.distance && *evidence.distance > least
             ? "; by satellite positions the paths are " +
                   std::to_string(std::lround(*evidence.distance)) + " m apart"
             : "";
}

/** "`b`: no place in common ...; `c`: no ..."; empty if all are joined. */
std::string unjoined(const std::vector<RunFolder>& runs, const RunMerge& merge)
{
  std::string text;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (merge.joined(r))
    {
      continue;
    }
    const JoinEvidence& evidence = merge.evidence[r];
    if (evidence.contradiction)
    {
      appendWord(
          text,
          contradictionOf(runs[r], runs[evidence.contradiction->run], *evidence.contradiction),
          "; ");
    }
    else
    {
      appendWord(text,
                 runs[r].folder + ": no place in common with " + runs.front().folder +
                     (runs.size() > 2 ? " or with a run joined to it" : "") + " was recognised (" +
                     reasonOf(evidence) + distanceOf(evidence) + ")",
                 "; ");
    }
  }
  return text;
}

std::size_t joinedRuns(const RunMerge& merge)
{
  return static_cast<std::size_t>(std::count_if(merge.poses.begin(), merge.poses.end(),
                                                [](const auto& poses) { return !poses.empty(); }));
}

/** One per run; empty where it is not joined. */
std::vector<Trajectory> mergedTrajectories(const std::vector<RunFolder>& runs,
                                           const RunMerge& merge)
{
  std::vector<Trajectory> merged;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    merged.push_back(merge.joined(r) ? mergedTrajectory(runs[r], merge.poses[r]) : Trajectory());
  }
  return merged;
}

/** Reads the recording of a joined run into the map. \return what is wrong with it */
std::string addRecording(const RunFolder& run,
                         const Trajectory& merged,
                         MapListener& listener,
                         MapBuilder& builder,
                         std::size_t& scans)
{
  RunScansOptions options = run.scans;
  options.name = run.name;
  options.tracks.clear();  // labels, else hindsight, give the moving points
  builder.beginRun(merged, options);
  RawlogSource source(run.rawlog, run.source);
  std::string damage = readScansAndWarn(source, "map, " + run.name, listener,
                                        [&](Frame frame) { builder.add(std::move(frame)); });
  scans += source.framesRead();
  return damage;
}

/** \throws UserError if an output needs a reference that no run has. */
void requireReferences(const std::vector<RunFolder>& runs,
                       const RunMergerOptions& merge,
                       const MapOutputs& outputs)
{
  const auto any = [&](const auto& has) { return std::any_of(runs.begin(), runs.end(), has); };
  if (outputs.utm && (!merge.gnss || !any([](const RunFolder& run)
                                          { return run.references.georeference.has_value(); })))
  {
    throw UserError(
        "--utm: no run has a georeference.ini; give one of a recording with satellite positions "
        "(and merge.gnss=true)");
  }
  if (!outputs.utm && !outputs.T_fixed_map && outputs.exports.epsg != 0)
  {
    throw UserError(
        "map_export.epsg: the merged map is in the map frame of its first run; --utm or --map-pose "
        "writes it in a reference system");
  }
  if (merge.level_map && (!merge.gravity || !any([](const RunFolder& run)
                                                 { return run.references.gravity.has_value(); })))
  {
    throw UserError(
        "merge.level_map: no run has found the vertical; give one of a recording with "
        "accelerations (and merge.gravity=true)");
  }
}

/** The outputs of a map in UTM, which state the zone unless another reference system is given.
 * \throws UserError for the number of another zone. */
MapOutputs inZoneOf(const Georeference& georeference, MapOutputs outputs)
{
  requireZone(outputs.exports.epsg, georeference.epsg);
  if (outputs.exports.epsg == 0)
  {
    outputs.exports.epsg = georeference.epsg;
    save(outputs.exports, outputs.settings, "map_export");
  }
  return outputs;
}

/** Removes a file of an earlier merge that is not of this one. */
void removeStale(const std::string& path)
{
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

/** What the satellite positions and verticals of the merged runs show. \param table of the runs */
std::string referencesText(const Table& table, const RunMerge& merge)
{
  std::string text = table.rows() > 0 ? table.toText() : "";
  if (merge.georeference)
  {
    text += formatted(
        "satellite receivers: %s, %.2f m from the merged trajectories, %.2f m in height "
        "(RMS)\n",
        counted(merge.georeference->fixes, "position").c_str(), merge.georeference->horizontal_rmse,
        merge.georeference->vertical_rmse);
  }
  if (merge.gravity)
  {
    const Gravity& gravity = *merge.gravity;
    text += formatted(
        "accelerometers: z of the merged map %s %.1f deg from the vertical (sigma %.1f "
        "deg)%s\n",
        gravity.levelled ? "was" : "is", degrees_per_radian * gravity.tilt,
        degrees_per_radian * gravity.tilt_sigma, gravity.levelled ? "; the map was levelled" : "");
  }
  return text;
}

/** Georeference, trajectories in UTM and the references' table, as far as there are references,
 * each also if another cannot be written. \param report gets table and summary as text
 * \return what failed; empty if nothing did */
std::string writeReferences(const std::vector<RunFolder>& runs,
                            const RunMerge& merge,
                            const std::vector<Trajectory>& merged,
                            const MapOutputs& outputs,
                            MergeReport& report)
{
  const Table table = referenceTable(runs, merge);
  report.references = referencesText(table, merge);
  const std::string table_file = outputs.beside("_merge_references.csv");
  const std::string georeference_file = outputs.beside("_georeference.ini");
  removeStale(table_file);
  removeStale(georeference_file);
  std::vector<FileWriter> writers;
  if (table.rows() > 0)
  {
    writers.push_back({table_file, [&] { writeWhole(table_file, table.toCsv()); }});
  }
  if (merge.georeference)
  {
    writers.push_back(
        {georeference_file, [&] { writeGeoreference(*merge.georeference, georeference_file); }});
  }
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    const std::string utm_file = outputs.beside("_" + runs[r].name + "_utm.txt");
    removeStale(utm_file);
    if (merge.georeference && merge.joined(r))
    {
      writers.push_back({utm_file, [&, r, utm_file]
                         {
                           writeTum(utm_file, inUtm(runs[r].source.levelling().recorded(merged[r]),
                                                    *merge.georeference));
                         }});
    }
  }
  return writeEach(writers);
}

/** Trajectories, table and picture, each also if another cannot be written. \param report gets the
 * table as text \return what failed; empty if nothing did */
std::string writeMerge(const std::vector<RunFolder>& runs,
                       const MergedRuns& joined,
                       const std::vector<Trajectory>& merged,
                       const MapBuilder& builder,
                       const MapOutputs& outputs,
                       MergeReport& report)
{
  std::vector<FileWriter> writers;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    const std::string tum = outputs.beside("_" + runs[r].name + "_tum.txt");
    const std::string kitti = outputs.beside("_" + runs[r].name + "_kitti.txt");
    if (!joined.merge.joined(r))
    {
      removeStale(tum);
      removeStale(kitti);
    }
    else
    {
      const Trajectory poses = outputs.inFixedFrame(runs[r].source.levelling().recorded(merged[r]));
      writers.push_back({tum, [tum, poses] { writeTum(tum, poses); }});
      writers.push_back({kitti, [kitti, poses] { writeKittiPoses(kitti, poses); }});
    }
  }
  const Table table = mergeTable(runs, joined, merged);
  report.table = table.toText();
  const std::string csv = outputs.beside("_merge.csv");
  writers.push_back({csv, [&] { writeWhole(csv, table.toCsv()); }});
  if (!outputs.comparison.empty())
  {
    writers.push_back({outputs.comparison, [&]
                       { writeMergePicture(runs, joined.merge, builder, outputs.comparison); }});
  }
  return writeEach(writers);
}
}  // namespace

MergeReport mergeMaps(const std::vector<RunFolder>& runs,
                      const RunMergerConfig& merger,
                      const MapBuilderOptions& options,
                      const MapOutputs& outputs,
                      MapListener& listener)
{
  requireValidExports(outputs);
  requireReferences(runs, merger.merge, outputs);
  const MapProducts products = productsFor(outputs);
  MapBuilderOptions own = options;
  own.hindsight.hindsight = true;  // of runs without labels: nothing else gives their moving points
  RunMergerConfig limited = merger;
  limited.memory = MemoryLimit(own.memory, products.temporary_folder);
  const MergedRuns joined = mergeRuns(runs, limited, own.map, own.threads, listener);
  if (const std::string& full = limited.memory.file->problem(); !full.empty())
  {
    listener.warn(full);
  }
  const std::vector<Trajectory> merged = mergedTrajectories(runs, joined.merge);
  std::string problem = unjoined(runs, joined.merge);
  if (joinedRuns(joined.merge) < 2)
  {
    throw UserError(problem + "; nothing was written");
  }
  const std::optional<Georeference>& georeference = joined.merge.georeference;
  if (outputs.utm && !georeference)
  {
    throw UserError("--utm: no run with satellite positions could be joined; " + problem +
                    "; nothing was written");
  }
  const MapOutputs of_map = outputs.utm ? inZoneOf(*georeference, outputs) : outputs;
  MapBuilder builder(own, products);
  std::size_t scans = 0;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merged[r].empty())
    {
      const std::string damage = addRecording(
          runs[r], outputs.utm ? inUtm(merged[r], *georeference) : outputs.inFixedFrame(merged[r]),
          listener, builder, scans);
      problem += (problem.empty() || damage.empty() ? "" : "; ") + damage;
    }
  }
  builder.finish();
  MergeReport report;
  static_cast<MapReport&>(report) = writeMapOutputs(builder, of_map, listener);
  const std::string of_references = writeReferences(runs, joined.merge, merged, outputs, report);
  const std::string of_merge = writeMerge(runs, joined, merged, builder, outputs, report);
  report.joined = joinedRuns(joined.merge);
  report.scans = scans;
  for (const std::string& more :
       {of_references, of_merge,
        problem.empty() ? problem : problem + "; the map of the rest was written"})
  {
    if (!more.empty())
    {
      appendWord(report.problem, more, "; ");
    }
  }
  return report;
}
}  // namespace dyslam
