// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/PendingFile.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/RunFiles.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** CRC-32 of successive pieces of data. \param sum checksum of the pieces before */
[[nodiscard]] std::uint32_t checksum(std::string_view bytes, std::uint32_t sum = 0);

/** Writes a state: parts of bytes, each with its length and checksum, as a PendingFile. */
class StateFileWriter
{
 public:
  /** \throws UserError, as all functions, if the file cannot be written. */
  explicit StateFileWriter(const std::string& path);

  /** Adds a part with the data that `save` saves, without holding them in memory. */
  void add(const std::function<void(StateArchive&)>& save);
  void add(std::string_view part);
  /** To be called after the last part: renames the file once it is on the disk. */
  void commit();

 private:
  void requireWritten();

  PendingFile pending_;
  std::ofstream file_;
};

/** Reads a file of StateFileWriter part by part. */
class StateFileReader
{
 public:
  /** Reads the whole file once, to test it.
   * \throws UserError for a file that is missing, damaged or of another version, or has another
   * number of parts. */
  StateFileReader(const std::string& path, std::size_t parts);

  /** Archive to load a part from the file. Only one at a time; the reader outlives it. */
  [[nodiscard]] StateArchive part(std::size_t i);

 private:
  struct Part
  {
    std::uint64_t offset = 0;
    std::uint64_t size = 0;
  };

  void read(void* data, std::uint64_t size);
  void test(const Part& part, std::uint64_t sum);

  std::string path_;
  std::ifstream file_;
  std::uint64_t left_ = 0;  //!< number of bytes not read yet
  std::vector<Part> parts_;
};
}  // namespace dyslam
