// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** Locks a folder against other runs during its lifetime. A killed run leaves the file of its lock,
 * but not the lock. */
class FolderLock
{
 public:
  /** \throws UserError if the folder is locked or cannot be written. */
  explicit FolderLock(const std::string& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::string path_;
  int file_ = -1;
};
}  // namespace dyslam
