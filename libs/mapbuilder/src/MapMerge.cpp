// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/Printable.h>
#include <dyslam/core/Words.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/ScanReading.h>

#include <algorithm>
#include <cmath>
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

/** "`b`: no place in common ...; `c`: no ..."; empty if all are joined. */
std::string unjoined(const std::vector<RunFolder>& runs, const RunMerge& merge)
{
  std::string text;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merge.joined(r))
    {
      appendWord(text,
                 runs[r].folder + ": no place in common with " + runs.front().folder +
                     (runs.size() > 2 ? " or with a run joined to it" : "") + " was recognised (" +
                     reasonOf(merge.evidence[r]) + ")",
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

/** Trajectories, table and picture. \return the table as text */
std::string writeMerge(const std::vector<RunFolder>& runs,
                       const MergedRuns& joined,
                       const std::vector<Trajectory>& merged,
                       const MapBuilder& builder,
                       const MapOutputs& outputs)
{
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (joined.merge.joined(r))
    {
      const Trajectory poses = runs[r].source.levelling().recorded(merged[r]);
      writeTum(outputs.beside("_" + runs[r].name + "_tum.txt"), poses);
      writeKittiPoses(outputs.beside("_" + runs[r].name + "_kitti.txt"), poses);
    }
  }
  const Table table = mergeTable(runs, joined, merged);
  writeWhole(outputs.beside("_merge.csv"), table.toCsv());
  if (!outputs.comparison.empty())
  {
    writeMergePicture(runs, joined.merge, builder, outputs.comparison);
  }
  return table.toText();
}
}  // namespace

MergeReport mergeMaps(const std::vector<RunFolder>& runs,
                      const RunMergerConfig& merger,
                      const MapBuilderOptions& options,
                      const MapOutputs& outputs,
                      MapListener& listener)
{
  requireValidExports(outputs);
  MapBuilderOptions own = withNeedsOf(outputs, options);
  own.hindsight.hindsight = true;  // of runs without labels: nothing else gives their moving points
  RunMergerConfig limited = merger;
  limited.memory = MemoryLimit(own.memory, own.temporary_folder);
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
  MapBuilder builder(own);
  std::size_t scans = 0;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merged[r].empty())
    {
      const std::string damage = addRecording(runs[r], merged[r], listener, builder, scans);
      problem += (problem.empty() || damage.empty() ? "" : "; ") + damage;
    }
  }
  builder.finish();
  MergeReport report;
  static_cast<MapReport&>(report) = writeMapOutputs(builder, outputs, listener);
  report.table = writeMerge(runs, joined, merged, builder, outputs);
  report.joined = joinedRuns(joined.merge);
  report.scans = scans;
  report.problem = problem.empty() ? problem : problem + "; the map of the rest was written";
  return report;
}
}  // namespace dyslam
