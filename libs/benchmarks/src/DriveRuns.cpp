// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/SplitTables.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Folders of runs by drive, then by folder of the column. */
using RunFolders = std::map<std::string, std::map<std::string, fs::path>>;

/** Folders of all columns; several columns may be of the same runs. */
std::set<std::string> methodsOf(const SplitColumns& columns)
{
  std::set<std::string> methods{columns.whole};
  for (const std::vector<RunColumn>* some : {&columns.odometry, &columns.labels})
  {
    for (const RunColumn& column : *some)
    {
      methods.insert(column.folder);
    }
  }
  return methods;
}

/** Folders of `runs` that have a run in each DRIVE/METHOD. */
RunFolders byDrive(const std::string& runs, const std::set<std::string>& methods)
{
  RunFolders found;
  for (const std::string& drive : foldersIn(runs))
  {
    for (const std::string& method : methods)
    {
      const fs::path folder = fs::path(runs) / drive / method;
      if (fs::is_directory(folder))
      {
        found[drive][method] = folder;
      }
    }
  }
  return found;
}

/** Whether a folder is that of a run, or of one that failed in a batch. */
bool isOfRun(const fs::path& folder)
{
  return whyNoRun(folder.string()).empty() || fs::exists(folder / run_files::report) ||
         fs::exists(folder / "manifest.json");
}

/** Folders of `runs`, or of all folders, that have a run in each METHOD/DRIVE. */
RunFolders byMethod(const std::string& runs, const std::set<std::string>& methods)
{
  RunFolders found;
  for (const std::string& method : methods)
  {
    const fs::path of_method = fs::path(runs) / method;
    if (!fs::is_directory(of_method))
    {
      continue;
    }
    for (const std::string& drive : foldersIn(of_method.string()))
    {
      if (isOfRun(of_method / drive))
      {
        found[drive][method] = of_method / drive;
      }
    }
  }
  return found;
}

/** \throws UserError if there are none. */
RunFolders runFolders(const std::string& runs, const SplitColumns& columns)
{
  const std::set<std::string> methods = methodsOf(columns);
  if (runs.empty())
  {
    for (const std::string& method : methods)
    {
      if (!fs::is_directory(method))
      {
        throw UserError(method + ": is not a folder");
      }
      if (byMethod("", {method}).empty())
      {
        throw UserError(method +
                        ": has no DRIVE with results of dyslam; dyslam-batch makes such a "
                        "folder");
      }
    }
    return byMethod("", methods);
  }
  if (!fs::is_directory(runs))
  {
    throw UserError(runs + ": is not a folder");
  }
  RunFolders found = byDrive(runs, methods);
  found = found.empty() ? byMethod(runs, methods) : found;
  if (found.empty())
  {
    throw UserError(runs +
                    ": has no DRIVE/METHOD or METHOD/DRIVE with results of dyslam; "
                    "scripts/split_tables.sh makes such a folder, and --runs names those of "
                    "dyslam-batch");
  }
  return found;
}
}  // namespace

SplitRuns readDrives(const std::string& runs,
                     const SplitColumns& columns,
                     const TrajectoryMetricsOptions& metrics,
                     const NoteSink& note)
{
  SplitRuns found;
  for (const auto& [name, folders] : runFolders(runs, columns))
  {
    DriveScores drive;
    drive.name = name;
    for (const auto& [method, folder] : folders)
    {
      try
      {
        drive.runs.emplace(method, scoresOf(folder.string(), "", metrics, note));
      }
      catch (const UserError& error)
      {
        found.failed.push_back(folder.string());
        note(printable(folder.string()) + ": not evaluated: " + printable(error.what()));
      }
    }
    if (!drive.runs.empty())
    {
      found.drives.push_back(std::move(drive));
    }
  }
  if (found.drives.empty())
  {
    throw UserError((runs.empty() ? "the folders of --runs have" : runs + ": has") +
                    std::string(" no run that can be read"));
  }
  return found;
}
}  // namespace dyslam
