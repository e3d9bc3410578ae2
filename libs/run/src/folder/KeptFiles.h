// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "OutputName.h"

namespace dyslam
{
/** Copies of numbered files as they are at the last checkpoint of a stopped run, for the run that
 * is resumed there: finishing the stopped run still changes files of earlier scans. The copies are
 * hard links, since the files are replaced but never written again. */
class KeptFiles
{
 public:
  /** \param folder folder of the run */
  explicit KeptFiles(const std::string& folder) : folder_(folder) {}

  /** \param name folder of files that may change, in the run's \return folder of their copies */
  OutputName add(const OutputName& name);

  /** Links all existing files. \throws UserError, std::filesystem::filesystem_error. */
  void keep() const;
  /** Removes the copies of files that have not changed since. */
  void removeUnchanged() const;
  void removeAll() const;
  /** Replaces changed files by their copies. \throws std::filesystem::filesystem_error. */
  void restore() const;

 private:
  /** Calls `use` with the paths of each copy and of its original; removes empty folders. */
  template <typename Use>
  void forEach(const Use& use) const;

  std::filesystem::path folder_;
  std::vector<OutputName> names_;
};
}  // namespace dyslam
