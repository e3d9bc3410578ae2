// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace dyslam
{
/** Reads a gzip or plain file, knowing a clean end from a cut. */
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
  void noteError();

  std::string path_;
  gzFile file_ = nullptr;
  std::uint64_t size_ = 0;
  bool cut_ = false;
  bool broken_ = false;
  std::string read_error_;
};
}  // namespace dyslam
