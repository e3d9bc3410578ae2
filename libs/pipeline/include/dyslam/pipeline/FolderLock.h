// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace dyslam
{
/** Keeps other runs out of a folder while it lives. A run that is killed leaves its lock's file,
 * not the lock. */
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
