// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/FactorGraphFile.h>
#include <dyslam/backend/PriorMapOptions.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/GeoreferenceFile.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/RunFolder.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* runs_to_merge = "output folders of dyslam (--merge)";

/** \param advice what to give instead; for an unfinished run the advice is to complete it */
std::string fileOf(const std::string& folder,
                   const std::string& name,
                   const std::string& what,
                   const std::string& advice = runs_to_merge)
{
  const std::string path = (fs::path(folder) / name).string();
  if (!fs::exists(path))
  {
    throw UserError(
        folder + ": has no " + name + ", which " + what + "; " +
        (fs::exists(fs::path(folder) / run_files::state)
             ? "the run is unfinished: dyslam --resume -o " + shellWord(folder) + " completes it"
             : "give " + advice));
  }
  return path;
}

/** Empty if the folder does not have it. */
std::string fileIfThere(const std::string& folder, const std::string& name)
{
  const fs::path path = fs::path(folder) / name;
  return fs::exists(path) ? path.string() : std::string();
}

/** \throws UserError if the recording of a run is not there. \param advice what to give then */
void requireRecording(const std::string& rawlog, const std::string& run, const std::string& advice)
{
  if (!fs::exists(rawlog))
  {
    throw UserError(rawlog + ": the recording of " + run + " is not there; if it was moved, give " +
                    advice);
  }
}

/** \param advice as of fileOf() \throws UserError if there is no report or it is damaged. */
RunReport reportOf(const std::string& folder, const std::string& advice = runs_to_merge)
{
  const std::string path = fileOf(folder, run_files::report, "names the recording", advice);
  return parseRunReport(readWhole(path), path);
}

/** Name of the frame of a run's map: the prior map that the run was localised in, by its path, else
 * the folder of the run. If the prior map is that of a run, the frame is that of this run.
 * \param longest number of runs, each localised in the map of the next, that are followed */
std::string mapFrameOf(const std::string& folder, int longest = 16)
{
  const std::string own = fs::weakly_canonical(folder).string();
  const std::string settings = fileIfThere(folder, run_files::settings);
  const auto fit = runReportIfValid(folder).prior_map;
  if (settings.empty() || !fit || !fit->localised || longest == 0)
  {
    return own;
  }
  const Config config = Config::fromFile(settings);
  const std::string file = ConfigLoader(config).get<PriorMapOptions>("prior_map").file;
  if (file.empty())
  {
    return own;
  }
  fs::path map = fs::weakly_canonical(file);
  if (map.filename() == run_files::map_pcd || map.filename() == run_files::map_ply)
  {
    map = map.parent_path();
  }
  return fs::is_directory(map) ? mapFrameOf(map.string(), longest - 1) : map.string();
}

/** Georeference, vertical and frame of a run. \throws UserError. */
RunReferences referencesOf(const std::string& folder,
                           const RunReport& report,
                           const FactorGraph& graph)
{
  RunReferences references;
  const std::string georeference =
      graph.contains(Key::georeference())
          ? fileOf(folder, run_files::georeference, "places its satellite positions")
          : fileIfThere(folder, run_files::georeference);
  if (!georeference.empty())
  {
    references.georeference = readGeoreference(georeference);
  }
  references.gravity = report.gravity;
  references.map_frame = mapFrameOf(folder);
  return references;
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
    throw UserError(run.folder + ": is not a folder; give " + runs_to_merge);
  }
  const RunReport report = reportOf(run.folder);
  run.rawlog = run.rawlog.empty() ? recordingOf(report, run.folder) : run.rawlog;
  requireRecording(run.rawlog, run.folder, run.folder + "=RECORDING");
  run.trajectory = readTum(fileOf(run.folder, run_files::trajectory, "has the poses"));
  run.graph = readFactorGraph(fileOf(run.folder, run_files::factor_graph, "has the odometry"));
  run.references = referencesOf(run.folder, report, run.graph);
  const std::string motions =
      fileOf(run.folder, run_files::motions, "has the times of the keyframes");
  run.keyframe_stamps = keyframeStamps(motions);
  if (run.keyframe_stamps.empty() || run.keyframe_stamps.size() != keyframesOf(run.graph))
  {
    throw UserError(motions + ": has " + std::to_string(run.keyframe_stamps.size()) +
                    " keyframes, but factor_graph.txt has " +
                    std::to_string(keyframesOf(run.graph)) + "; are they of one run?");
  }
  const Config config =
      Config::fromFile(fileOf(run.folder, run_files::settings, "has the settings"));
  ConfigLoader loader(config);
  run.source = loader.get<RawlogSourceOptions>("input");
  run.trajectory = run.source.levelling().levelled(std::move(run.trajectory));
  run.scans.preprocess = loader.get<PreprocessOptions>("preprocess");
  run.scans.tolerance = tolerance;
  run.scans.scan_table = fileIfThere(run.folder, run_files::scan_table);
  run.scans.labels = labelFolderOf(run.folder).value_or("");
  run.scans.tracks = run.scans.labels.empty() ? fileIfThere(run.folder, run_files::tracks) : "";
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
  // A folder stands before the sign, which names of folders and recordings may have, too.
  std::size_t split = fs::exists(argument) ? std::string::npos : argument.rfind('=');
  while (split != std::string::npos && !fs::is_directory(argument.substr(0, split)))
  {
    split = split == 0 ? std::string::npos : argument.rfind('=', split - 1);
  }
  if (split != std::string::npos)
  {
    folder = argument.substr(0, split);
    rawlog = argument.substr(split + 1);
  }
}

void completeFromRun(const std::string& folder, RecordingOnTrajectory& recording)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": is not a folder; give the output folder of dyslam (--run)");
  }
  if (recording.rawlog.empty())
  {
    recording.rawlog = recordingOf(reportOf(folder, "the recording with --input"), folder);
    requireRecording(recording.rawlog, folder, "--input RECORDING");
  }
  if (recording.trajectory.empty())
  {
    recording.trajectory =
        fileOf(folder, run_files::trajectory, "has the poses", "them with --trajectory");
    recording.unfinished = !runReportIfValid(folder).finished;
  }
  RunScansOptions& scans = recording.scans;
  scans.labels = scans.labels.empty() ? labelFolderOf(folder).value_or("") : scans.labels;
  scans.tracks = scans.tracks.empty() ? fileIfThere(folder, run_files::tracks) : scans.tracks;
}

std::string settingsOfRun(const std::string& folder)
{
  return fileOf(folder, run_files::settings, "has the settings", "them with --config");
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
