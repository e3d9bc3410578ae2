// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>

#include <fstream>
#include <optional>
#include <string>

namespace dyslam
{
/** A text file that grows, readable as `<name>.tmp`, while a run goes on, and gets its name when it
 * is whole. */
class StreamedFile
{
 public:
  /** \throws UserError. */
  void open(const std::string& path, const std::string& header = "")
  {
    pending_.emplace(path);
    file_.open(pending_->temporary());
    if (!file_)
    {
      throw UserError(path + ": cannot be written; choose another --output or fix its permissions");
    }
    write(header);
  }
  /** Only close() tells whether it could be written. */
  void write(const std::string& text) { file_ << text << std::flush; }
  /** \throws UserError if not all could be written. */
  void close()
  {
    file_.close();
    if (!file_)
    {
      throw UserError(pending_->path() + ": not everything could be written; is the disk full?");
    }
    pending_->commit();
  }

 private:
  std::optional<PendingFile> pending_;
  std::ofstream file_;
};
}  // namespace dyslam
