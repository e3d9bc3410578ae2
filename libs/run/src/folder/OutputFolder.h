// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/run/FolderLock.h>

#include <string>
#include <vector>

#include "OutputName.h"

namespace dyslam
{
/** Output folder of a run: created if missing, locked, and without files of an earlier run, so that
 * all files found there afterwards are of one run. */
class OutputFolder
{
 public:
  /** \param names files that runs write, removed from the last to the first; nothing else is
   * removed, and no link is followed \param inputs files that the run reads \param force replace
   * also files that no run wrote \throws UserError if the folder cannot be written or another run
   * writes to it, if an input is among the files to be removed, and if there are files of those
   * names but no run's. */
  OutputFolder(const std::string& folder,
               const std::vector<OutputName>& names,
               const std::vector<std::string>& inputs,
               bool force);
  /** Locks the folder of a resumed run, without removing anything. \throws UserError. */
  explicit OutputFolder(const std::string& folder) : lock_(folder) {}

 private:
  FolderLock lock_;
};
}  // namespace dyslam
