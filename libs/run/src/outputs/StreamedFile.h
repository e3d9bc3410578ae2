// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

namespace dyslam
{
/** A text file that grows during a run, readable as `<name>.tmp`, and is renamed when it is
 * complete. */
class StreamedFile
{
 public:
  /** Creates the file. \throws UserError if it cannot be written. */
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
  /** See PendingFile::keep(). */
  void keep() { pending_->keep(); }
  /** Appends to the file. \throws UserError if it could not be written. */
  void write(const std::string& text)
  {
    file_ << text << std::flush;
    requireGood();
    size_ += text.size();
  }
  /** Saves the length of the file, or continues a saved file.
   * \throws UserError if the file is shorter. */
  void exchangeState(const std::string& path, StateArchive& archive)
  {
    archive(size_);
    if (archive.isLoading())
    {
      pending_.emplace(path);
      pending_->keep();
      cutPending(*pending_, size_);
      file_.open(pending_->temporary(), std::ios::app);
    }
  }
  /** Closes and renames the file. \throws UserError if not all could be written. */
  void close()
  {
    file_.close();
    requireGood();
    pending_->commit();
  }

 private:
  void requireGood() const
  {
    if (!file_)
    {
      throw UserError(pending_->path() + ": not everything could be written; is the disk full?");
    }
  }

  std::optional<PendingFile> pending_;
  std::ofstream file_;
  std::uint64_t size_ = 0;
};
}  // namespace dyslam
