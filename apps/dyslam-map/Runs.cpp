// SPDX-License-Identifier: BSD-3-Clause
#include "Runs.h"

#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Options.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapping/MovingInMap.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "ScanReading.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

std::string fileOf(const std::string& folder, const std::string& name, const std::string& what)
{
  const std::string path = (fs::path(folder) / name).string();
  if (!fs::exists(path))
  {
    throw UserError(folder + ": has no " + name + ", which " + what +
                    "; give output folders of dyslam (--merge)");
  }
  return path;
}

std::string inputOf(const std::string& report)
{
  const auto json = nlohmann::json::parse(readWhole(report), nullptr, false);
  if (!json.is_object() || !json.contains("input") || !json["input"].is_string())
  {
    throw UserError(report + ": does not name the recording (\"input\"); is it of dyslam?");
  }
  return json["input"].get<std::string>();
}

/** Folder and recording of one `--merge`. */
std::pair<std::string, std::string> partsOf(const std::string& argument)
{
  const std::size_t split = argument.rfind('=');
  if (split != std::string::npos && !fs::exists(argument))
  {
    return {argument.substr(0, split), argument.substr(split + 1)};
  }
  return {argument, ""};
}

std::vector<double> keyframeStamps(const std::string& motions)
{
  std::vector<double> stamps;
  for (const MotionCovariance& motion : readMotionFile(motions))
  {
    if (motion.is_keyframe)
    {
      stamps.push_back(motion.stamp);
    }
  }
  return stamps;
}

std::size_t keyframesOf(const FactorGraph& graph)
{
  std::size_t count = 0;
  while (graph.contains(Key::ego(count)))
  {
    ++count;
  }
  return count;
}

Run readRun(const std::string& argument, double tolerance)
{
  Run run;
  std::tie(run.folder, run.rawlog) = partsOf(argument);
  if (!fs::is_directory(run.folder))
  {
    throw UserError(run.folder + ": is not a folder; give output folders of dyslam (--merge)");
  }
  const std::string report = fileOf(run.folder, "report.json", "names the recording");
  run.rawlog = run.rawlog.empty() ? inputOf(report) : run.rawlog;
  if (!fs::exists(run.rawlog))
  {
    throw UserError(run.rawlog + ": the recording of " + run.folder +
                    " is not there; if it was moved, give " + run.folder + "=RECORDING");
  }
  run.trajectory = readTum(fileOf(run.folder, "trajectory_tum.txt", "has the poses"));
  run.graph = readFactorGraph(fileOf(run.folder, "factor_graph.txt", "has the odometry"));
  const std::string motions = fileOf(run.folder, "motions.csv", "has the times of the keyframes");
  run.keyframe_stamps = keyframeStamps(motions);
  if (run.keyframe_stamps.empty() || run.keyframe_stamps.size() != keyframesOf(run.graph))
  {
    throw UserError(motions + ": has " + std::to_string(run.keyframe_stamps.size()) +
                    " keyframes, but factor_graph.txt has " +
                    std::to_string(keyframesOf(run.graph)) + "; are they of one run?");
  }
  const Config config = Config::fromFile(fileOf(run.folder, "effective.ini", "has the settings"));
  ConfigLoader loader(config);
  run.source = loader.get<RawlogSourceOptions>("input");
  run.scans.preprocess = loader.get<PreprocessOptions>("preprocess");
  run.scans.tolerance = tolerance;
  const auto optional = [&](const char* name)
  {
    const fs::path path = fs::path(run.folder) / name;
    return fs::exists(path) ? path.string() : std::string();
  };
  run.scans.labels = optional("labels");
  run.scans.tracks = run.scans.labels.empty() ? optional("tracks.txt") : "";
  return run;
}

/** The last parts of the folders, as many as make them differ. */
void nameRuns(std::vector<Run>& runs)
{
  std::set<std::string> folders;
  for (Run& run : runs)
  {
    const fs::path whole = fs::weakly_canonical(run.folder);
    if (!folders.insert(whole.string()).second)
    {
      throw UserError(run.folder + ": is given twice (--merge)");
    }
    run.name = whole.filename().string();
  }
  std::multiset<std::string> names;
  for (const Run& run : runs)
  {
    names.insert(run.name);
  }
  for (Run& run : runs)
  {
    if (names.count(run.name) > 1)
    {
      run.name =
          fs::weakly_canonical(run.folder).parent_path().filename().string() + "_" + run.name;
    }
  }
  for (std::size_t i = 0; i < runs.size(); ++i)
  {
    for (std::size_t j = 0; j < i; ++j)
    {
      if (runs[i].name == runs[j].name)
      {
        runs[i].name += "_" + std::to_string(i + 1);
      }
    }
  }
}

/** Static points of a keyframe: by labels, else outside the boxes of tracked objects.
 */
std::vector<Eigen::Vector3f> staticPoints(const RunScans& scans, Frame& frame, std::size_t pose)
{
  frame.T_odom_vehicle = scans.trajectory()[pose].pose;
  scans.fillCloud(frame, pose);
  scans.fillMoving(frame);
  for (TrackedObject& object : frame.objects)
  {
    object.dynamic = true;
  }
  const std::vector<bool> moving = movingInMap(frame, StaticMapOptions());
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (!moving[i])
    {
      points.push_back(frame.cloud.points[i]);
    }
  }
  return points;
}

void addRun(Run& run, ThreadPool& pool, bool quiet, RunMerger& merger)
{
  merger.addRun(run.graph);
  const RunScans scans(run.trajectory, run.scans, pool);
  RawlogSource source(run.rawlog, run.source);
  std::size_t next = 0;
  bool found = false;
  const std::string damage =
      readScans(source, "dyslam-map (" + run.name + ")", quiet,
                [&](Frame frame)
                {
                  if (frame.T_world_vehicle_truth)
                  {
                    run.truth.push_back(frame.scan.stamp, *frame.T_world_vehicle_truth);
                  }
                  const auto stamp = [&](std::size_t k) { return run.keyframe_stamps[k]; };
                  while (next < run.keyframe_stamps.size() &&
                         stamp(next) < frame.scan.stamp - run.scans.tolerance)
                  {
                    merger.addKeyframe({});  // its scan is not in the recording any more
                    ++next;
                  }
                  const auto pose = scans.poseOf(frame);
                  if (pose && next < run.keyframe_stamps.size() &&
                      std::abs(stamp(next) - frame.scan.stamp) <= run.scans.tolerance)
                  {
                    merger.addKeyframe(staticPoints(scans, frame, *pose));
                    ++next;
                    found = true;
                  }
                });
  if (!found)
  {
    throw UserError(run.rawlog + ": " +
                    (damage.empty() ? "has none of the keyframes of " + run.folder +
                                          "; is it the recording of that run?"
                                    : damage));
  }
  for (; next < run.keyframe_stamps.size(); ++next)
  {
    merger.addKeyframe({});
  }
}
}  // namespace

std::vector<Run> readRuns(const std::vector<std::string>& folders, double tolerance)
{
  if (folders.size() < 2)
  {
    throw UserError("--merge: give two runs or more");
  }
  std::vector<Run> runs;
  for (const std::string& folder : folders)
  {
    runs.push_back(readRun(folder, tolerance));
  }
  nameRuns(runs);
  return runs;
}

RunMerge mergeRuns(std::vector<Run>& runs, const RunMergerConfig& config, int threads, bool quiet)
{
  ThreadPool pool(threads);
  RunMerger merger(config);
  for (Run& run : runs)
  {
    addRun(run, pool, quiet, merger);
  }
  return merger.merge();
}

Trajectory mergedTrajectory(const Run& run, const std::vector<Pose>& merged)
{
  Trajectory result;
  std::size_t k = 0;
  const std::size_t last = merged.size() - 1;
  for (const auto& [stamp, pose] : run.trajectory)
  {
    while (k < last && run.keyframe_stamps[k + 1] <= stamp)
    {
      ++k;
    }
    const auto from = [&](std::size_t keyframe, const Pose& T)
    { return Pose(merged[keyframe] * run.graph.pose(Key::ego(keyframe)).inverse() * T); };
    Pose corrected = from(k, pose);
    if (k < last && stamp > run.keyframe_stamps[k])
    {
      const double span = run.keyframe_stamps[k + 1] - run.keyframe_stamps[k];
      corrected =
          interpolate(corrected, from(k + 1, pose), (stamp - run.keyframe_stamps[k]) / span);
    }
    result.push_back(stamp, orthonormalized(corrected));
  }
  return result;
}
}  // namespace dyslam
