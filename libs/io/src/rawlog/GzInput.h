// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct inflate_state;

namespace dyslam
{
/** Reads a gzip or plain file, and detects truncation. Unpacked by ISA-L, in a third of zlib's
 * time. What follows the last gzip member is not read, as by zlib: see restAt().
 *
 * A file that is still being written (dyslam/base/GrowingFile.h) is followed: at its present end
 * the reader waits for more, until the writer closes it or the reader is stopped. */
class GzInput
{
 public:
  /** \param stop asked while the reader waits for more of a file that grows; true: the file ends
   * where it ends now. Null for never.
   * \throws UserError if the file is missing, a folder or unreadable. */
  explicit GzInput(const std::string& path, std::function<bool()> stop = nullptr);
  ~GzInput();
  GzInput(const GzInput&) = delete;
  GzInput& operator=(const GzInput&) = delete;

  /** Reads exactly `count` bytes. \throws std::runtime_error if there are fewer. */
  std::size_t Read(void* buffer, std::size_t count);
  /** Reads up to `count` bytes. \return their number; 0 at the end, also of a truncated file. */
  std::size_t readSome(void* buffer, std::size_t count);
  /** Unpacks the rest of the present gzip member, whose checksum is behind its data: data that make
   * no sense may be damaged ones. Nothing can be read afterwards. \return broken() */
  bool checkMember();
  /** Records that data are missing at the end: the file is cut short, or damaged at restAt(). */
  void noteCut();

  /** True if no byte is left; whyIncomplete() then tells whether some are missing. */
  [[nodiscard]] bool atEnd();
  /** Whether reading ended as `stop` asked for it, and the file has more or will have. */
  [[nodiscard]] bool isStopped() const { return is_stopped_; }
  /** Whether the file ended where data should be. */
  [[nodiscard]] bool cut() const { return cut_; }
  /** Whether the compressed data are damaged. */
  [[nodiscard]] bool broken() const { return broken_; }
  /** Byte of the file from which on it is no gzip member, and not zeros either: other data, or a
   * member whose header is damaged. Nothing if there are none, or before the end. */
  [[nodiscard]] std::optional<std::uint64_t> restAt() const { return rest_at_; }
  /** Reason why data are missing or left over at the end, such as "the file is cut short"; else
   * empty. */
  [[nodiscard]] std::string whyIncomplete() const;
  /** Reason why a file that is not truncated could not be read to its end; else empty. */
  [[nodiscard]] const std::string& readError() const { return read_error_; }
  /** Fraction of the file's bytes consumed; of a file that grows, of those it has so far. */
  [[nodiscard]] double progress() const;
  [[nodiscard]] std::uint64_t fileSize() const { return size_; }

 private:
  /** Unpacks the next piece where nothing unpacked is left. */
  void fillContent();
  /** Reads on until `count` bytes are there, or the file ends. \return whether they are. */
  bool fillPacked(std::size_t count);
  /** Size of the file, which may have become larger. */
  [[nodiscard]] std::uint64_t presentSize() const;
  /** Waits for more of a file that grows. \return false if nothing more will come. */
  bool waitForMore();
  /** Begins the gzip member that comes next. \return false if none does. */
  bool beginMember();
  void unpackSome();
  /** Finds what follows the last member. */
  void lookForRest();

  [[nodiscard]] std::size_t packedSize() const { return packed_end_ - packed_begin_; }

  std::string path_;
  std::function<bool()> stop_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;            //!< size of the file [bytes]
  bool grows_ = false;                //!< the file is still being written
  std::uint64_t offset_ = 0;          //!< offset of the next read in the file [bytes]
  std::vector<std::uint8_t> packed_;  //!< of the file; not yet unpacked from packed_begin_ on
  std::size_t packed_begin_ = 0;
  std::size_t packed_end_ = 0;
  std::vector<std::uint8_t> content_;  //!< unpacked; not yet read from content_begin_ on
  std::size_t content_begin_ = 0;
  std::size_t content_end_ = 0;
  bool is_full_ = false;  //!< the last piece filled content_: more may follow without more input
  std::unique_ptr<inflate_state> inflate_;  //!< null: the file is not compressed
  std::size_t members_ = 0;                 //!< number of gzip members begun
  bool is_between_ = false;                 //!< behind a gzip member, before the next one
  bool ended_ = false;                      //!< nothing more can be unpacked
  bool is_stopped_ = false;
  bool cut_ = false;
  bool broken_ = false;
  std::optional<std::uint64_t> rest_at_;
  std::string read_error_;
};
}  // namespace dyslam
