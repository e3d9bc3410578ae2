// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>

namespace dyslam
{
/** Whether a file's bytes are on the disk before it gets its name (fsync): a power cut then leaves
 * all of it or none. Not worth the time for each of thousands of small files. */
enum class Durable
{
  yes,
  no
};

/** A file that is written under a temporary name and renamed when it is complete.
 *
 * Write to temporary(), check that everything was written, then commit(). Without a commit()
 * the destructor removes the temporary file, and an earlier file of the name stays as it was. A
 * killed program leaves the `.tmp`.
 */
class PendingFile
{
 public:
  /** Opens nothing yet. \throws UserError if `path` is a folder. */
  explicit PendingFile(const std::string& path);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  /** Path of the temporary file: `<path>.tmp`. */
  [[nodiscard]] const std::string& temporary() const { return temporary_; }
  /** Keeps the temporary file even without commit(): a resumed run may have to be resumed again. */
  void keep() { kept_ = true; }
  /** Renames the closed file to its final name. \throws UserError. */
  void commit(Durable durable = Durable::yes);

 private:
  std::string path_;
  std::string temporary_;
  bool committed_ = false;
  bool kept_ = false;
};

/** Writes a file by `write`, as a PendingFile: it is never incomplete. \throws UserError. */
void writeWhole(const std::string& path,
                const std::function<void(std::ostream&)>& write,
                Durable durable = Durable::yes);
void writeWhole(const std::string& path, std::string_view content, Durable durable = Durable::yes);

/** Truncates the temporary file of a killed program to the size that is known to be valid. A file
 * that was already renamed gets its temporary name again.
 * \throws UserError if the file is shorter. */
void cutPending(const PendingFile& pending, std::uint64_t size);
}  // namespace dyslam
