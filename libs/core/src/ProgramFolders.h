// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace dyslam
{
/** Where the files that come with DySLAM may be, in the order in which they are looked for. */
struct ProgramFolders
{
  std::string environment;          //!< variable that names a folder
  std::filesystem::path build;      //!< of programs in the build folder: no other is looked at then
  std::filesystem::path relative;   //!< to the prefix that the program is installed in
  std::filesystem::path installed;  //!< where DySLAM was configured to be installed

  [[nodiscard]] std::vector<std::filesystem::path> candidates() const;
};
}  // namespace dyslam
