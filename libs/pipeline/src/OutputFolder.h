// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/pipeline/FolderLock.h>

#include <string>
#include <vector>

#include "RunOutput.h"

namespace dyslam
{
/** The folder of a run, made where it is missing, locked, and without the files of an earlier run,
 * so that everything found there afterwards is of one run. */
class OutputFolder
{
 public:
  /** \param names what runs write, removed from the last to the first; nothing else is removed, and
   *   no link is followed.
   * \param inputs files that the run reads. \param force replace files that no run wrote, too.
   * \throws UserError if the folder cannot be written or another run writes to it, if an input is
   *   among the files to be removed, and if there are files of those names but no run's. */
  OutputFolder(const std::string& folder,
               const std::vector<OutputName>& names,
               const std::vector<std::string>& inputs,
               bool force);
  /** The folder of a run that goes on, locked, with all that is in it. \throws UserError. */
  explicit OutputFolder(const std::string& folder) : lock_(folder) {}

 private:
  FolderLock lock_;
};
}  // namespace dyslam
