// SPDX-License-Identifier: BSD-3-Clause
#include "MapPictures.h"

#include <dyslam/base/Bytes.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/mapping/MapDifference.h>
#include <dyslam/plot/MapPicture.h>

#include <filesystem>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

std::vector<Eigen::Vector3d> pathOf(const Trajectory& trajectory)
{
  std::vector<Eigen::Vector3d> path;
  for (const auto& [stamp, pose] : trajectory)
  {
    path.emplace_back(pose.translation());
  }
  return path;
}

/** Paths and objects of all runs, without points. */
MapPictureContent pathsOf(const MapBuilder& builder)
{
  MapPictureContent content;
  for (const RunScans& run : builder.runs())
  {
    if (builder.runs().size() == 1)
    {
      content.path = pathOf(run.trajectory());
    }
    else
    {
      const std::string number = "run " + std::to_string(content.runs.size() + 1);
      content.runs.push_back({run.name().empty() ? number : run.name(), pathOf(run.trajectory())});
    }
    for (const auto& [id, object] : run.movingObjects())
    {
      content.objects.push_back({object.last.object_class, object.path, object.last.box});
    }
  }
  return content;
}
}  // namespace

void writeMapPicture(const MapBuilder& builder, const std::string& path)
{
  MapPictureContent content = pathsOf(builder);
  const MapPoints points = builder.map().points();
  content.points = &points.points;
  writeWhole(path, bytesOf(renderMapPicture(content)));
}

void writeCleaningPicture(const MapBuilder& builder, const std::string& path)
{
  MapPictureContent after = pathsOf(builder);
  after.objects.clear();
  const MapPoints clean = builder.map().points();
  after.points = &clean.points;
  MapPictureContent before = after;
  const MapPoints all = builder.uncleanedMap()->points();
  const std::vector<Eigen::Vector3f> removed = removedPoints(all, builder.map());
  before.points = &all.points;
  before.marked = &removed;
  writeWhole(path, bytesOf(renderMapComparison({"everything that was seen; red: removed", before},
                                               {"static map", after})));
}

void writeMergePicture(const std::vector<RunFolder>& runs,
                       const RunMerge& merge,
                       const MapBuilder& builder,
                       const std::string& path)
{
  std::vector<Eigen::Vector3f> points;
  MapPictureContent before;
  for (std::size_t r = 0; r < runs.size(); ++r)
  {
    if (!merge.joined(r))
    {
      continue;
    }
    const fs::path map = fs::path(runs[r].folder) / run_files::map_ply;
    if (fs::exists(map))
    {
      const Scan scan = readCloud(map.string());
      points.insert(points.end(), scan.points.begin(), scan.points.end());
    }
    before.runs.push_back({runs[r].name, pathOf(runs[r].trajectory)});
  }
  before.points = &points;
  MapPictureContent after = pathsOf(builder);
  after.objects.clear();
  const MapPoints merged = builder.map().points();
  after.points = &merged.points;
  writeWhole(
      path, bytesOf(renderMapComparison({"each run in its own frame", before}, {"merged", after})));
}
}  // namespace dyslam
