// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Disk space for data that does not fit into memory.
 *
 * The file has no name: nothing is left of it when the program ends or is killed. It is created by
 * the first write. Not thread-safe.
 */
class SwapFile
{
 public:
  /** A range of the file. */
  struct Slot
  {
    std::uint64_t offset = 0;
    std::uint32_t size = 0;      //!< length of the content [bytes]
    std::uint32_t capacity = 0;  //!< length of the range [bytes]; 0: nothing was written yet
  };

  /** \param folder where the file is created; has to exist at the first write */
  explicit SwapFile(std::string folder);
  ~SwapFile();
  SwapFile(const SwapFile&) = delete;
  SwapFile& operator=(const SwapFile&) = delete;

  /** Writes `bytes` to the slot, which moves if it is too small.
   * \return false if the disk is full or fails; the slot keeps its place, with undefined content,
   * and nothing is written any more: problem() has the reason. */
  bool write(std::string_view bytes, Slot& slot);
  /** \throws UserError if it can't be read. */
  [[nodiscard]] std::string read(const Slot& slot) const;
  /** Frees the slot for reuse. */
  void release(Slot& slot);

  /** Length of the file [bytes]. */
  [[nodiscard]] std::uint64_t size() const { return end_; }
  /** Why nothing is written any more, one sentence; empty as long as all is well. */
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  [[nodiscard]] bool open();
  [[nodiscard]] bool fail(int error);

  std::string folder_;
  int file_ = -1;
  std::uint64_t end_ = 0;
  std::map<std::uint32_t, std::vector<std::uint64_t>> unused_;  //!< free slots: offsets by capacity
  std::string problem_;
};

/** Ini section `[memory]`. */
struct MemoryOptions : Options
{
  /** Limit above which clouds of keyframes, voxels of the map and similar data are on disk [MB]. */
  int limit = 512;
  void describe(OptionsVisitor& visitor) override;
};

/** Memory limit, and the file for data beyond it. */
struct MemoryLimit
{
  MemoryLimit() = default;
  /** \param folder of the temporary file */
  MemoryLimit(const MemoryOptions& options, const std::string& folder);
  /** A limit of `share` of the bytes, with the same file. */
  [[nodiscard]] MemoryLimit part(double share) const;

  std::shared_ptr<SwapFile> file;  //!< null: everything stays in memory
  std::size_t bytes = std::numeric_limits<std::size_t>::max();
};
}  // namespace dyslam
