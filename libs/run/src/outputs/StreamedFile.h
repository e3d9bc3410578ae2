// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

namespace dyslam
{
/** A text file that grows during a run, readable as `<name>.tmp`, and is renamed when it is
 * complete. Rows that cannot be written, as on a full disk, stay in memory until they can. */
class StreamedFile
{
 public:
  /** Creates the file. \throws UserError if it cannot be written. */
  void open(const std::string& path, const std::string& header = "");
  /** See PendingFile::keep(). */
  void keep() { pending_->keep(); }
  /** Appends to the file, or to what is to be written with the next text. */
  void write(const std::string& text);
  /** Saves the length of the file and what is not written yet, or continues a saved file. From then
   * on the file is kept, see PendingFile::keep(). \throws UserError if the file is shorter. */
  void exchangeState(const std::string& path, StateArchive& archive);
  /** Closes and renames the file. \throws UserError if not all could be written. */
  void close();

 private:
  /** \return whether all is written */
  bool writeWaiting();
  /** After a failure: opens the file again, without the part of a text that was written. */
  void reopen();
  /** \throws UserError */
  void requireWritten(bool is_written) const;

  std::optional<PendingFile> pending_;
  std::ofstream file_;
  std::uint64_t size_ = 0;  //!< of the complete texts in the file [bytes]
  std::string waiting_;     //!< texts that are not in the file yet
};
}  // namespace dyslam
