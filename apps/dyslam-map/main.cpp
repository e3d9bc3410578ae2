// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/Printable.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "Arguments.h"
#include "MapWriting.h"
#include "MergeReport.h"
#include "Runs.h"
#include "ScanReading.h"

namespace
{
/** Formats whose coordinates are float32 or small keys. */
void warnOfOrigin(const dyslam::MapBuilder& builder, const dyslam::Arguments& a)
{
  const Eigen::Vector3d& origin = builder.origin();
  if (origin.isZero(0))
  {
    return;
  }
  for (const auto& path : a.outputs)
  {
    const std::string ending = std::filesystem::path(path).extension().string();
    if (ending != ".las" && ending != ".ply" && ending != ".simplemap" && ending != ".png")
    {
      std::fprintf(
          stderr,
          "warning: %s: coordinates so far from zero would be rounded: the map is relative "
          "to %.0f %.0f %.0f\n",
          path.c_str(), origin.x(), origin.y(), origin.z());
    }
  }
}

void printWarnings(const dyslam::RawlogSource& source)
{
  for (const auto& warning : source.warnings())
  {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
}

/** Settings implied by the flags of this program. */
void prepare(dyslam::Arguments& a)
{
  dyslam::checkOutputs(a);
  dyslam::loadConfig(a);
  a.builder.labelled_map = !a.labelled_map.empty();
  a.builder.whole_map = dyslam::needsWholeMap(a);
  a.builder.uncleaned_map = !a.compare.empty() && a.runs.empty();
  a.builder.scan_store = dyslam::needsScans(a) ? a.outputs.front() + ".scans" : "";
  const std::string ini = dyslam::effectiveIniOf(a);
  a.builder.temporary_folder =
      std::filesystem::absolute(ini.empty() ? a.labelled_map : ini).parent_path().string();
}

/** Writes all outputs except the settings. \return points written */
std::size_t writeMap(dyslam::MapBuilder& builder, const dyslam::Arguments& a)
{
  warnOfOrigin(builder, a);
  const std::size_t points = dyslam::writeOutputs(builder, a);
  if (!builder.memoryProblem().empty())
  {
    std::fprintf(stderr, "warning: %s\n", builder.memoryProblem().c_str());
  }
  if (const std::string ini = dyslam::effectiveIniOf(a); !ini.empty())
  {
    dyslam::writeWhole(ini, a.effective);
  }
  return points;
}

void printCounts(const dyslam::MapBuilder& builder,
                 const dyslam::Arguments& a,
                 std::size_t scans,
                 std::size_t points)
{
  const double voxel = a.builder.whole_map ? builder.map().voxelSize() : a.builder.map.voxel_size;
  std::printf("%s, %zu without a pose, %s, %s%s\n", dyslam::counted(scans, "scan").c_str(),
              builder.skipped(), dyslam::counted(builder.keyframes(), "keyframe").c_str(),
              dyslam::counted(points, "map point").c_str(),
              a.exports.full_resolution
                  ? ""
                  : (" of " + std::to_string(voxel).substr(0, 4) + " m").c_str());
}

void runSingle(dyslam::Arguments& a)
{
  dyslam::requireConverted(a.rawlog);
  prepare(a);
  dyslam::MapBuilder builder(a.builder);
  dyslam::RawlogSource source(a.rawlog, a.source);
  builder.beginRun(dyslam::readPoses(a), a.scans);
  if (!a.scans.tracks.empty())
  {
    // Boxes know the number of their scan alone: stamps and the lidar's place are in the rawlog.
    dyslam::RawlogSource first_pass(a.rawlog, a.source);
    std::size_t scans = 0;
    (void)dyslam::readScans(first_pass, "dyslam-map (tracks)", a.quiet,
                            [&](const dyslam::Frame& frame)
                            {
                              scans = frame.index + 1;
                              builder.noteObjects(frame);
                            });
    if (a.source.only_first_n == 0 && builder.trackedScans() > scans)
    {
      std::fprintf(stderr,
                   "warning: %s: has boxes up to scan %zu, but %s has %s; are they of one "
                   "recording?\n",
                   a.scans.tracks.c_str(), builder.trackedScans() - 1, a.rawlog.c_str(),
                   dyslam::counted(scans, "scan").c_str());
    }
  }
  const std::string damage = dyslam::readScans(
      source, "dyslam-map", a.quiet, [&](dyslam::Frame frame) { builder.add(std::move(frame)); });
  printWarnings(source);
  builder.finish();
  if (!damage.empty() && source.framesRead() == 0)
  {
    throw dyslam::UserError(damage);
  }
  if (builder.keyframes() == 0)
  {
    throw dyslam::UserError(a.trajectory + ": has no pose for any scan of " + a.rawlog +
                            "; are they of one recording? (--tolerance)");
  }
  const std::size_t points = writeMap(builder, a);
  if (!a.labelled_map.empty())
  {
    const auto& labelled = builder.labelledMap();
    dyslam::writeCloud(a.labelled_map, labelled.points);
    dyslam::writeLabels(std::filesystem::path(a.labelled_map).replace_extension(".label").string(),
                        labelled.labels);
  }
  if (!damage.empty())
  {
    throw dyslam::UserError(damage + "; the map of the " + std::to_string(source.framesRead()) +
                            " scans before it was written");
  }
  printCounts(builder, a, source.framesRead(), points);
}

/** Reads the recordings of the joined runs into the map. \return scans; damage is added to it */
std::size_t addRuns(const std::vector<dyslam::Run>& runs,
                    const std::vector<dyslam::Trajectory>& merged,
                    bool quiet,
                    dyslam::MapBuilder& builder,
                    std::string& damage)
{
  std::size_t scans = 0;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (merged[r].empty())
    {
      continue;
    }
    dyslam::RunScansOptions options = runs[r].scans;
    options.tracks.clear();  // labels or hindsight give the moving points
    builder.beginRun(merged[r], options);
    dyslam::RawlogSource source(runs[r].rawlog, runs[r].source);
    const std::string one =
        dyslam::readScans(source, "dyslam-map (map, " + runs[r].name + ")", quiet,
                          [&](dyslam::Frame frame) { builder.add(std::move(frame)); });
    printWarnings(source);
    damage = damage.empty() ? one : damage;
    scans += source.framesRead();
  }
  builder.finish();
  return scans;
}

void runMerged(dyslam::Arguments& a)
{
  std::vector<dyslam::Run> runs = dyslam::readRuns(a.runs, a.scans.tolerance);
  prepare(a);
  const dyslam::RunMerge merge = dyslam::mergeRuns(runs, a.merger, a.builder.threads, a.quiet);
  const std::string unjoined = dyslam::namesOfUnjoined(runs, merge);
  std::vector<dyslam::Trajectory> merged;
  std::size_t joined = 0;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    joined += merge.joined(r) ? 1 : 0;
    merged.push_back(merge.joined(r) ? dyslam::mergedTrajectory(runs[r], merge.poses[r])
                                     : dyslam::Trajectory());
  }
  const std::string problem = unjoined + ": no place in common with " + runs.front().folder +
                              (runs.size() > 2 ? " or with a run joined to it" : "") +
                              " was recognised";
  if (joined < 2)
  {
    throw dyslam::UserError(problem + "; nothing was written");
  }
  std::string damage;
  dyslam::MapBuilder builder(a.builder);
  const std::size_t scans = addRuns(runs, merged, a.quiet, builder, damage);
  const std::size_t points = writeMap(builder, a);
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (merge.joined(r))
    {
      dyslam::writeTum(dyslam::besideOutput(a, "_" + runs[r].name + "_tum.txt"), merged[r]);
      dyslam::writeKittiPoses(dyslam::besideOutput(a, "_" + runs[r].name + "_kitti.txt"),
                              merged[r]);
    }
  }
  const dyslam::Table table = dyslam::mergeTable(runs, merge, merged);
  dyslam::writeWhole(dyslam::besideOutput(a, "_merge.csv"), table.toCsv());
  if (!a.compare.empty())
  {
    dyslam::writeRunComparison(runs, merge, builder, a.compare);
  }
  std::printf("%s%zu of %zu runs joined, ", table.toText().c_str(), joined, runs.size());
  printCounts(builder, a, scans, points);
  if (!unjoined.empty() || !damage.empty())
  {
    throw dyslam::UserError((unjoined.empty() ? damage : problem) +
                            "; the map of the rest was written");
  }
}

void run(dyslam::Arguments& a)
{
  if (a.runs.empty())
  {
    runSingle(a);
  }
  else
  {
    runMerged(a);
  }
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { dyslam::declare(app, a); }, [&] { run(a); });
}
