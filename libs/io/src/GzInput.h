// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

struct libdeflate_decompressor;

namespace dyslam
{
/** Reads a gzip or plain file, knowing a clean end from a cut.
 *
 * Members as small as GzOutput writes them are unpacked whole, which takes a quarter of the time;
 * from the first that is larger or damaged on, zlib reads the file as a stream. */
class GzInput
{
 public:
  /** \throws UserError if the file is missing, a folder or unreadable. */
  explicit GzInput(const std::string& path);
  ~GzInput();
  GzInput(const GzInput&) = delete;
  GzInput& operator=(const GzInput&) = delete;

  /** All `count` bytes, or std::runtime_error. */
  std::size_t Read(void* buffer, std::size_t count);
  /** Up to `count` bytes. \return how many; 0 at the end, be it where it should or not. */
  std::size_t readSome(void* buffer, std::size_t count);
  /** To be called where more should have followed at the end. */
  void noteCut() { cut_ = true; }

  /** True if no byte is left; ok() then says whether the file ends as it should. */
  [[nodiscard]] bool atEnd();
  /** Ran into the end of the file where data should be. */
  [[nodiscard]] bool cut() const { return cut_; }
  /** The compressed data are broken. */
  [[nodiscard]] bool broken() const { return broken_; }
  /** Why the file could not be read to its end, though it has one; empty if it could. */
  [[nodiscard]] const std::string& readError() const { return read_error_; }
  /** Fraction of the file's bytes consumed. */
  [[nodiscard]] double progress() const;
  [[nodiscard]] std::uint64_t fileSize() const { return size_; }

 private:
  /** Unpacks the next member. False where the file ends or zlib has to go on. */
  bool nextMember();
  /** Nothing unpacked is left, nor a member to unpack. */
  bool atEndOfMembers();
  void fillPacked();
  /** Hands the rest of the file to zlib. */
  void startStream();
  void noteError();

  std::string path_;
  int descriptor_ = -1;       //!< until zlib has it
  std::vector<char> packed_;  //!< of the file, not yet unpacked
  std::size_t packed_begin_ = 0;
  std::uint64_t offset_ = 0;  //!< in the file of the byte at packed_begin_
  bool any_member_ = false;
  std::vector<char> content_;      //!< unpacked
  std::size_t content_begin_ = 0;  //!< not yet read
  std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor_;
  gzFile file_ = nullptr;  //!< null until zlib reads
  std::uint64_t size_ = 0;
  bool cut_ = false;
  bool broken_ = false;
  std::string read_error_;
};
}  // namespace dyslam
