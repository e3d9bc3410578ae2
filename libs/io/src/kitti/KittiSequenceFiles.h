// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/io/KittiExport.h>

#include <filesystem>
#include <string>

namespace dyslam
{
/** The files of a sequence in a dataset with KITTI's layout while they are written: they have other
 * names until install(), and are removed with the object without it.
 *
 * A file in the folder of the sequence (`rawlog2kitti.ini`) tells it from an original one, of which
 * nothing is replaced or removed. */
class KittiSequenceFiles
{
 public:
  /** \param folder of the dataset
   * \throws UserError if a file to be written is there already and may not be replaced */
  KittiSequenceFiles(const std::filesystem::path& folder, const KittiExportOptions& options);
  ~KittiSequenceFiles();
  KittiSequenceFiles(const KittiSequenceFiles&) = delete;
  KittiSequenceFiles& operator=(const KittiSequenceFiles&) = delete;

  /** The folder of the sequence until install(). */
  [[nodiscard]] const std::filesystem::path& sequence() const { return sequence_.pending; }
  /** Makes that folder. */
  void beginSequence();
  /** Makes the folder of the poses. \return the file of the poses until install() */
  std::string beginPoses();
  /** Makes the folder of the tracks. \return the file of the tracks until install() */
  std::string beginTracks();
  /** Gives all that was written its name, in place of an earlier export, of which nothing stays. */
  void install();

 private:
  /** A file or folder before and after install(). */
  struct Target
  {
    std::filesystem::path path;
    std::filesystem::path pending;
    bool is_written = false;
  };

  /** Whether the folder of a sequence was made by an export. */
  [[nodiscard]] static bool isExport(const std::filesystem::path& sequence);
  void requireReplaceable(const Target& target, bool force) const;
  void requireNoOtherFiles() const;
  std::string begin(Target& file);
  void writeMark() const;
  void installFile(const Target& file, const std::string& name) const;

  Target sequence_;
  Target poses_;
  Target tracks_;
};
}  // namespace dyslam
