// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/io/CloudFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "../common/AppMain.h"
#include "../common/Progress.h"
#include "MapBuilder.h"

namespace
{
struct Arguments
{
  std::string rawlog;
  std::string trajectory;
  std::string config;
  std::vector<std::string> assignments;
  std::vector<std::string> outputs;
  dyslam::MapBuilderOptions builder;
  dyslam::RawlogSourceOptions source;
  dyslam::MapExportOptions exports;
  std::string labelled_map;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& a)
{
  app.description("Builds the static map of a rawlog along a trajectory");
  app.add_option("-i,--input", a.rawlog, "rawlog of 3D LiDAR scans")->required();
  app.add_option("--trajectory", a.trajectory, "poses of the scans: TUM, or KITTI line by line")
      ->required();
  app.add_option("-o,--output", a.outputs,
                 "map.{pcd,ply,bt,ot,simplemap,3Dscene,png}; any number (png: grid with its yaml)");
  app.add_option("--labels", a.builder.labels,
                 "folder of .label files: moving points are left out");
  app.add_option("--tracks", a.builder.tracks, "tracks.txt: objects that move are left out");
  app.add_option("-c,--config", a.config, "ini file with [map], [preprocess] and [map_export]");
  app.add_option("--set", a.assignments, "section.key=value, as if it stood in the ini; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  app.add_option("--keyframe-distance", a.builder.keyframe_distance,
                 "a scan is used after so much way [m]; 0: every scan")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--tolerance", a.builder.tolerance, "largest difference of time stamps [s]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--skip-first-n", a.source.skip_first_n, "scans to pass over")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--only-first-n", a.source.only_first_n, "scans to use after those; 0: all")
      ->check(CLI::NonNegativeNumber);
  app.add_option(
      "--labelled-map", a.labelled_map,
      "also write all points with the true labels of --labels or --tracks (F.ply, F.label): "
      "the reference for dyslam-eval map");
  app.add_flag("-q,--quiet", a.quiet, "no progress");
}

/** Reads our sections of the ini; an ini of a whole run may hold others. */
void loadConfig(Arguments& a)
{
  dyslam::Config config;
  if (!a.config.empty())
  {
    config = dyslam::Config::fromFile(dyslam::findGivenOrShared(a.config, "config_files", ".ini"));
  }
  for (const auto& assignment : a.assignments)
  {
    const std::string section = assignment.substr(0, assignment.find('.'));
    if (section != "map" && section != "preprocess" && section != "map_export")
    {
      throw dyslam::UserError("--set " + assignment +
                              ": dyslam-map has the sections map, preprocess and map_export");
    }
    config.set(assignment);
  }
  dyslam::ConfigLoader loader(config);
  a.builder.map = loader.get<dyslam::StaticMapOptions>("map");
  a.builder.preprocess = loader.get<dyslam::PreprocessOptions>("preprocess");
  a.exports = loader.get<dyslam::MapExportOptions>("map_export");
  if (a.config.empty())
  {
    loader.requireAllUsed();
  }
}

void write(const dyslam::MapBuilder& builder, const std::string& path, const Arguments& a)
{
  using dyslam::MapFormat;
  switch (dyslam::mapFormatOf(path))
  {
    case MapFormat::pcd:
    case MapFormat::ply:
      dyslam::writeMapCloud(builder.map().points(), path);
      break;
    case MapFormat::octree:
      dyslam::writeOctomap(builder.map(), path, a.exports);
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
}

void run(Arguments& a)
{
  if (a.outputs.empty() && a.labelled_map.empty())
  {
    throw dyslam::UserError("nothing to write: give at least one --output");
  }
  loadConfig(a);
  a.builder.labelled_map = !a.labelled_map.empty();
  for (const auto& path : a.outputs)
  {
    // A bad ending or folder is told before the work, not after.
    (void)dyslam::mapFormatOf(path);
    const auto folder = std::filesystem::path(path).parent_path();
    if (!folder.empty() && !std::filesystem::is_directory(folder))
    {
      throw dyslam::UserError(path + ": its folder is not there; make it, or choose another");
    }
  }
  dyslam::MapBuilder builder(dyslam::readTrajectory(a.trajectory), a.builder);
  dyslam::RawlogSource source(a.rawlog, a.source);
  std::string damage;
  {
    dyslam::Progress progress("dyslam-map", "scans", a.quiet);
    try
    {
      while (auto frame = source.next())
      {
        builder.add(std::move(*frame));
        progress.update(source.progress(), source.framesRead());
      }
      progress.finish(source.framesRead());
    }
    catch (const dyslam::UserError& error)
    {
      damage = error.what();  // the map of the scans before it is worth keeping
    }
  }
  for (const auto& warning : source.warnings())
  {
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
  }
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
  Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a); }, [&] { run(a); });
}
