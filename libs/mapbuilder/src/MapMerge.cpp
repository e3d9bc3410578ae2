// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/ScanReading.h>

#include <algorithm>
#include <utility>

#include "MapPictures.h"
#include "MapWriting.h"
#include "MergeTable.h"
#include "RunMerging.h"

namespace dyslam
{
namespace
{
/** "`b`, `c`: no place in common ..."; empty if all are joined. */
std::string unjoined(const std::vector<RunFolder>& runs, const RunMerge& merge)
{
  std::string names;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merge.joined(r))
    {
      names += (names.empty() ? "" : ", ") + runs[r].folder;
    }
  }
  return names.empty()
             ? names
             : names + ": no place in common with " + runs.front().folder +
                   (runs.size() > 2 ? " or with a run joined to it" : "") + " was recognised";
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
  options.tracks.clear();  // labels or hindsight give the moving points
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
      writeTum(outputs.beside("_" + runs[r].name + "_tum.txt"), merged[r]);
      writeKittiPoses(outputs.beside("_" + runs[r].name + "_kitti.txt"), merged[r]);
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
  const MapBuilderOptions own = withNeedsOf(outputs, options);
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
