// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/run/FolderLock.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

FolderLock::FolderLock(const std::string& folder)
    : path_((fs::path(folder) / ".dyslam.lock").string())
{
  for (;;)
  {
    file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (file_ < 0)
    {
      throw UserError(folder + ": cannot be written: " + std::strerror(errno) +
                      "; choose another --output");
    }
    int locked = 0;
    do
    {
      locked = ::flock(file_, LOCK_EX | LOCK_NB);
    } while (locked != 0 && errno == EINTR);
    if (locked != 0 && errno == EWOULDBLOCK)  // other errors: the file system has no locks
    {
      ::close(file_);
      throw UserError(
          folder + ": another run is writing to it; wait for its end, or choose another --output");
    }
    // If another run has just ended, it has removed the locked file: the lock is void.
    struct stat named = {};
    struct stat held = {};
    if (::stat(path_.c_str(), &named) == 0 && ::fstat(file_, &held) == 0 &&
        named.st_ino == held.st_ino && named.st_dev == held.st_dev)
    {
      return;
    }
    ::close(file_);
  }
}

FolderLock::~FolderLock()
{
  ::unlink(path_.c_str());
  ::close(file_);
}
}  // namespace dyslam
