// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/formats/ScanFiles.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "Arguments.h"
#include "MapWriting.h"
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

void run(dyslam::Arguments& a)
{
  dyslam::requireConverted(a.rawlog);
  dyslam::checkOutputs(a);
  dyslam::loadConfig(a);
  a.builder.labelled_map = !a.labelled_map.empty();
  a.builder.whole_map = dyslam::needsWholeMap(a);
  a.builder.uncleaned_map = !a.compare.empty();
  a.builder.scan_store = dyslam::needsScans(a) ? a.outputs.front() + ".scans" : "";
  dyslam::RawlogSource source(a.rawlog, a.source);
  dyslam::MapBuilder builder(dyslam::readPoses(a), a.builder);
  if (!a.builder.tracks.empty())
  {
    // Boxes know the number of their scan alone: stamps and the lidar's place are in the rawlog.
    dyslam::RawlogSource first_pass(a.rawlog, a.source);
    (void)dyslam::readScans(first_pass, "dyslam-map (tracks)", a.quiet,
                            [&](const dyslam::Frame& frame) { builder.noteObjects(frame); });
  }
  const std::string damage = dyslam::readScans(
      source, "dyslam-map", a.quiet, [&](dyslam::Frame frame) { builder.add(std::move(frame)); });
  for (const auto& warning : source.warnings())
  {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
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
  warnOfOrigin(builder, a);
  const std::size_t points = dyslam::writeOutputs(builder, a);
  if (const std::string ini = dyslam::effectiveIniOf(a); !ini.empty())
  {
    dyslam::writeWhole(ini, a.effective);
  }
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
  const double voxel = a.builder.whole_map ? builder.map().voxelSize() : a.builder.map.voxel_size;
  std::printf("%zu scans, %zu without a pose, %zu keyframes, %zu map points%s\n",
              source.framesRead(), builder.skipped(), builder.keyframes(), points,
              a.exports.full_resolution
                  ? ""
                  : (" of " + std::to_string(voxel).substr(0, 4) + " m").c_str());
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { dyslam::declare(app, a); }, [&] { run(a); });
}
