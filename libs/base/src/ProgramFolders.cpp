// SPDX-License-Identifier: BSD-3-Clause
#include "ProgramFolders.h"

namespace fs = std::filesystem;

namespace dyslam
{
std::vector<fs::path> ProgramFolders::candidates() const
{
  std::vector<fs::path> folders;
  if (const std::string given = environmentValue(environment); !given.empty())
  {
    folders.emplace_back(given);
  }
  std::error_code ignored;
  const fs::path bin = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  if (!bin.empty() && fs::equivalent(bin, DYSLAM_BUILD_BIN, ignored))
  {
    folders.push_back(build);
    return folders;
  }
  if (!bin.empty())
  {
    folders.push_back(bin.parent_path() / relative);
  }
  folders.push_back(installed);
  return folders;
}
}  // namespace dyslam
