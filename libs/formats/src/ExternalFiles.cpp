// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Files.h>
#include <dyslam/formats/ExternalFiles.h>

#include <filesystem>

namespace dyslam
{
namespace
{
std::string besideWith(const char* ending, const std::string& rawlog)
{
  const std::filesystem::path path(rawlog);
  return (path.parent_path() / (path.stem().string() + ending)).string();
}
}  // namespace

std::string externalStorageFolder(const std::string& rawlog)
{
  return besideWith("_Images", rawlog);
}

std::optional<std::string> externalFolderOf(const std::string& rawlog)
{
  for (const char* ending : {"_Images", "_images", "_img", "_imgs"})
  {
    const std::string folder = besideWith(ending, rawlog);
    if (isFolder(folder))
    {
      return folder;
    }
  }
  return std::nullopt;
}
}  // namespace dyslam
