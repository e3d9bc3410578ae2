// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>

#include <string>
#include <vector>

namespace dyslam
{
/** A bag that is compressed as a whole with zstd, unpacked to a file in the folder for temporary
 * files ($TMPDIR, otherwise /tmp), which is removed with the object. */
class UnpackedBag
{
 public:
  /** \throws UserError if the bag can't be read or is damaged, or if there is no room for it. */
  UnpackedBag(const std::string& path, const BagUnpackingProgress& progress);

  /** Path of the unpacked file. */
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  class Folder
  {
   public:
    explicit Folder(const std::string& bag);
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

   private:
    std::string path_;
  };

  Folder folder_;
  std::string path_;
};

/** \param paths bags that are open at the same time \throws UserError if the folder for temporary
 * files has less room than those of them that are compressed as a whole state to need. */
void requireRoomToUnpack(const std::vector<std::string>& paths);
}  // namespace dyslam
