// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Options.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/RunFolder.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

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

RunFolder readRun(const std::string& argument, double tolerance)
{
  const RunArgument given(argument);
  RunFolder run;
  run.folder = given.folder;
  run.rawlog = given.rawlog;
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
  run.scans.scan_table = optional("scans.csv");
  run.scans.labels = optional("labels");
  run.scans.tracks = run.scans.labels.empty() ? optional("tracks.txt") : "";
  return run;
}

/** The last parts of the folders, as many as make them differ. */
void nameRuns(std::vector<RunFolder>& runs)
{
  std::set<std::string> folders;
  for (RunFolder& run : runs)
  {
    const fs::path whole = fs::weakly_canonical(run.folder);
    if (!folders.insert(whole.string()).second)
    {
      throw UserError(run.folder + ": is given twice (--merge)");
    }
    run.name = whole.filename().string();
  }
  std::multiset<std::string> names;
  for (const RunFolder& run : runs)
  {
    names.insert(run.name);
  }
  for (RunFolder& run : runs)
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
}  // namespace

RunArgument::RunArgument(const std::string& argument) : folder(argument)
{
  const std::size_t split = argument.rfind('=');
  if (split != std::string::npos && !fs::exists(argument))
  {
    folder = argument.substr(0, split);
    rawlog = argument.substr(split + 1);
  }
}

std::vector<RunFolder> readRunFolders(const std::vector<std::string>& folders, double tolerance)
{
  if (folders.size() < 2)
  {
    throw UserError("--merge: give two runs or more");
  }
  std::vector<RunFolder> runs;
  for (const std::string& folder : folders)
  {
    runs.push_back(readRun(folder, tolerance));
  }
  nameRuns(runs);
  return runs;
}
}  // namespace dyslam
