// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace dyslam
{
std::vector<std::string> filesOfRun(const std::string& folder)
{
  return runReportIfValid(folder).files;
}

bool isRunFolder(const std::string& folder)
{
  const std::filesystem::path path(folder);
  std::error_code ignored;
  return std::filesystem::is_regular_file(path / run_files::settings, ignored) &&
         std::filesystem::is_regular_file(path / run_files::report, ignored);
}

bool isFileOfRun(const std::string& file)
{
  const std::filesystem::path path(file);
  const auto names = filesOfRun(path.parent_path().string());
  return std::find(names.begin(), names.end(), path.filename().string()) != names.end();
}

std::string recordingOfRun(const std::string& folder, const std::string& input)
{
  const auto name = std::filesystem::path(input).filename();
  const auto beside = std::filesystem::path(folder) / name;
  const bool moved =
      !name.empty() && !std::filesystem::exists(input) && std::filesystem::exists(beside);
  return moved ? beside.string() : input;
}

std::string staticMapOfRun(const std::string& folder)
{
  for (const char* name : {run_files::map_pcd, run_files::map_ply})
  {
    const auto path = std::filesystem::path(folder) / name;
    if (std::filesystem::is_regular_file(path))
    {
      return path.string();
    }
  }
  return "";
}
}  // namespace dyslam
