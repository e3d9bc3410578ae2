// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/SharedFiles.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
std::vector<fs::path> sharedFolders()
{
  std::vector<fs::path> folders;
  if (const char* given = std::getenv("DYSLAM_SHARE"))
  {
    folders.emplace_back(given);
  }
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  if (!bin.empty() && fs::equivalent(bin, DYSLAM_BUILD_BIN, ignored))
  {
    folders.emplace_back(DYSLAM_SOURCE_SHARE);
    return folders;
  }
  if (!bin.empty())
  {
    folders.push_back(bin.parent_path() / "share" / "dyslam");
  }
  folders.emplace_back(DYSLAM_INSTALLED_SHARE);
  return folders;
}

std::string namesIn(const std::string& folder, const std::string& extension)
{
  std::vector<std::string> names;
  for (const auto& shared : sharedFolders())
  {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(shared / folder, ignored))
    {
      if (entry.path().extension() == extension)
      {
        names.push_back(entry.path().filename().string());
      }
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const auto& name : names)
  {
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}
}  // namespace

std::string findGivenOrShared(const std::string& path,
                              const std::string& folder,
                              const std::string& extension,
                              const std::string& field)
{
  if (fs::is_regular_file(path))
  {
    return path;
  }
  if (path.find('/') == std::string::npos)
  {
    for (const auto& shared : sharedFolders())
    {
      for (const auto& name : {path, path + extension})
      {
        if (fs::is_regular_file(shared / folder / name))
        {
          return (shared / folder / name).string();
        }
      }
    }
  }
  const std::string known = namesIn(folder, extension);
  throw UserError((field.empty() ? "" : field + " = ") + (path.empty() ? "(nothing)" : path) +
                  (fs::is_directory(path) ? ": is a folder" : ": no such file") +
                  (known.empty() ? "" : "; give a path or one of: " + known));
}
}  // namespace dyslam
