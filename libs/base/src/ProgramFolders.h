// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Environment.h>

#include <filesystem>
#include <string>
#include <vector>

namespace dyslam
{
/** Folders that may contain the files shipped with DySLAM, in the order of the search. */
struct ProgramFolders
{
  std::string environment;          //!< environment variable with a folder; none if it is empty
  std::filesystem::path build;      //!< the only further folder for programs in the build folder
  std::filesystem::path relative;   //!< folder relative to the prefix of the installed program
  std::filesystem::path installed;  //!< folder in the configured install prefix

  [[nodiscard]] std::vector<std::filesystem::path> candidates() const;
};
}  // namespace dyslam
