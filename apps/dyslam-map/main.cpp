// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/formats/ScanFiles.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"
#include "Arguments.h"
#include "MapBuilder.h"
#include "ScanReading.h"

namespace
{
void write(const dyslam::MapBuilder& builder, const std::string& path, const dyslam::Arguments& a)
{
  using dyslam::MapFormat;
  const std::size_t keyframes = builder.map().keyframes().size();
  dyslam::Progress progress(std::filesystem::path(path).filename().string(), "keyframes", a.quiet);
  switch (dyslam::mapFormatOf(path))
  {
    case MapFormat::pcd:
    case MapFormat::ply:
      dyslam::writeMapCloud(builder.map().points(), path);
      break;
    case MapFormat::octree:
      dyslam::writeOctomap(
          builder.map(), path, a.exports,
          [&](std::size_t done)
          { progress.update(static_cast<double>(done) / static_cast<double>(keyframes), done); });
      break;
    case MapFormat::simplemap:
      dyslam::writeSimplemap(builder.map(), path);
      break;
    case MapFormat::scene:
      dyslam::writeScene(builder.scene(), path);
      break;
    case MapFormat::grid:
      dyslam::writeOccupancyGrid(builder.map(), path, a.exports);
      break;
  }
  progress.finish(keyframes);
}

void run(dyslam::Arguments& a)
{
  dyslam::requireConverted(a.rawlog);
  dyslam::checkOutputs(a);
  dyslam::loadConfig(a);
  a.builder.labelled_map = !a.labelled_map.empty();
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
  if (builder.map().keyframes().size() == 0)
  {
    throw dyslam::UserError(a.trajectory + ": has no pose for any scan of " + a.rawlog +
                            "; are they of one recording? (--tolerance)");
  }
  for (const auto& path : a.outputs)
  {
    write(builder, path, a);
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
  std::printf("%zu scans, %zu without a pose, %zu keyframes, %zu map points of %.2f m\n",
              source.framesRead(), builder.skipped(), builder.map().keyframes().size(),
              builder.map().points().size(), builder.map().voxelSize());
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { dyslam::declare(app, a); }, [&] { run(a); });
}
