// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFolder.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <system_error>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** report.json goes first: a folder that has it is whole. */
constexpr std::array<const char*, 18> run_files = {
    "report.json",          "effective.ini",     "odometry_tum.txt",    "trajectory_tum.txt",
    "trajectory_kitti.txt", "reference_tum.txt", "trajectory.png",      "tracks.csv",
    "tracks.txt",           "graph.graph",       "graph.g2o",           "map_static.pcd",
    "map_static.ply",       "map.3Dscene",       "keyframes.simplemap", "replay.rawlog",
    "static_scans.rawlog",  "scans.csv"};

struct NumberedFiles
{
  const char* folder;
  const char* extension;
};
constexpr std::array<NumberedFiles, 2> numbered_files = {
    {{"labels", ".label"}, {"static_scans", ".bin"}}};

bool isNumbered(const fs::path& file, const char* extension)
{
  const std::string stem = file.stem().string();
  return file.extension() == extension && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::vector<fs::path> filesIn(const fs::path& folder)
{
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
  {
    files.push_back(it->path());
  }
  return files;
}
}  // namespace

void prepareOutputFolder(const std::string& folder, const std::string& input)
{
  const fs::path base = folder;
  makeFolder(folder, "choose another --output");
  for (const char* name : run_files)
  {
    std::error_code ignored;
    if (fs::equivalent(input, base / name, ignored))
    {
      throw UserError(input + ": would be replaced by this run's " + name +
                      "; choose another --output");
    }
  }
  const bool of_a_run = fs::exists(base / "effective.ini");
  for (const NumberedFiles& kind : numbered_files)
  {
    if (!of_a_run && !filesIn(base / kind.folder).empty())
    {
      throw UserError((base / kind.folder).string() +
                      ": holds files that are of no run; choose another --output");
    }
  }
  for (const char* name : run_files)
  {
    std::error_code ignored;
    fs::remove(base / name, ignored);
    fs::remove(base / (std::string(name) + ".tmp"), ignored);  // of a run that was killed
  }
  for (const NumberedFiles& kind : numbered_files)
  {
    for (const fs::path& file : filesIn(base / kind.folder))
    {
      if (isNumbered(file, kind.extension))
      {
        std::error_code ignored;
        fs::remove(file, ignored);
      }
    }
    std::error_code ignored;
    fs::remove(base / kind.folder, ignored);  // only if it is empty now
  }
}
}  // namespace dyslam
