// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/PendingFile.h>

#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct libdeflate_compressor;

namespace dyslam
{
class StateArchive;

/** When a file gets its name. */
enum class FileName
{
  at_end,   //!< as a PendingFile: close() renames it, without close() it is removed
  at_start  //!< it grows under its name (dyslam/base/GrowingFile.h), and stays without close()
};

/** Writes a gzip file for MRPT's archiveFrom(). The headers have no time, so that equal data give
 * equal files.
 *
 * The file is a sequence of gzip members of `member_size` bytes of content each, which readers
 * treat as one gzip file (RFC 1952, 2.2) and which can be packed and unpacked in one call each. */
class GzOutput
{
 public:
  static constexpr std::size_t member_size = std::size_t{1} << 20U;

  /** \param level 0 (none) to 9. \throws UserError. */
  GzOutput(const std::string& path, int level, FileName name = FileName::at_end);
  /** Continues the file of another object, saved by exchangeState(). */
  GzOutput(const std::string& path, int level, StateArchive& saved);
  ~GzOutput();
  GzOutput(const GzOutput&) = delete;
  GzOutput& operator=(const GzOutput&) = delete;

  /** Records a failure, which check() reports: MRPT would wrap an exception into pages of text. */
  std::size_t Write(const void* buffer, std::size_t count);
  std::size_t Read(void* buffer, std::size_t count);  //!< not supported: throws
  [[nodiscard]] std::string getStreamDescription() const { return path_; }
  /** Reports failures. \throws UserError if something could not be written. */
  void check() const;
  /** Saves or loads the length of the file and the content that is not packed yet. */
  void exchangeState(StateArchive& archive);
  /** Writes all so far as whole members, which readers of a file that grows then see.
   * \throws UserError if not all could be written. */
  void flush();
  /** Writes all that is left, still to the temporary file; only close() may follow. \throws
   * UserError if not all could be written. */
  void finish();
  /** Completes the file and renames it. \throws UserError if not all could be written. Later calls
   * do nothing. */
  void close();

 private:
  void open(const char* mode);
  void begin();
  void writeMember(const char* content, std::size_t size);

  std::string path_;
  std::optional<PendingFile> pending_;  //!< nothing: the file has its name
  std::FILE* file_ = nullptr;
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor_;
  std::vector<char> content_;  //!< content of the current member
  std::vector<char> packed_;   //!< buffer of a compressed member
  bool finished_ = false;      //!< all is written, and not renamed yet
  bool empty_ = true;          //!< no member was written
  std::string failure_;
};
}  // namespace dyslam
