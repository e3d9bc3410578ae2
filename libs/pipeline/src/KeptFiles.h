// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "RunOutput.h"

namespace dyslam
{
/** Numbered files as they are at the last checkpoint of a run that is stopped, for the run that is
 * resumed there: what is written after that checkpoint, from the scans so far alone, changes files
 * of earlier scans. They are kept as further links to the same files, which are replaced but never
 * written again. */
class KeptFiles
{
 public:
  /** \param folder of the run */
  explicit KeptFiles(const std::string& folder) : folder_(folder) {}

  /** \param name folder in that of the run, of files that may change \return where they are kept */
  OutputName add(const OutputName& name);

  /** Keeps all files that are there. \throws UserError, std::filesystem::filesystem_error. */
  void keep() const;
  /** Removes those that have not changed since. */
  void removeUnchanged() const;
  void removeAll() const;
  /** Puts them back in place of what has changed. \throws std::filesystem::filesystem_error. */
  void restore() const;

 private:
  /** Calls `use` with each kept file and the place where it was; removes empty folders. */
  template <typename Use>
  void forEach(const Use& use) const;

  std::filesystem::path folder_;
  std::vector<OutputName> names_;
};
}  // namespace dyslam
