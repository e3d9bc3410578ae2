// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/PendingFile.h>

#include <cstddef>
#include <string>

struct gzFile_s;  // zlib's

namespace dyslam
{
/** Writes a gzip file for MRPT's archiveFrom(), as a PendingFile: it gets its name by close() and
 * is gone without. The header holds no time: same data, same bytes. */
class GzOutput
{
 public:
  /** \param level 0 (none) to 9. \throws UserError. */
  GzOutput(const std::string& path, int level);
  ~GzOutput();
  GzOutput(const GzOutput&) = delete;
  GzOutput& operator=(const GzOutput&) = delete;

  /** Notes a failure, for check() to report: MRPT would wrap an exception into pages of text. */
  std::size_t Write(const void* buffer, std::size_t count);
  std::size_t Read(void* buffer, std::size_t count);  //!< throws
  [[nodiscard]] std::string getStreamDescription() const { return pending_.path(); }
  /** \throws UserError if something could not be written. */
  void check() const;
  /** \throws UserError if not all could be written. */
  void close();

 private:
  PendingFile pending_;
  gzFile_s* file_ = nullptr;
  std::string failure_;
};
}  // namespace dyslam
