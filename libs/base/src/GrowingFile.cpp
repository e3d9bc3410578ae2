// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace dyslam
{
namespace
{
/** flock() without waiting. \return 0, or the reason */
int tryLock(int descriptor, int kind)
{
  int result = 0;
  do
  {
    result = ::flock(descriptor, kind | LOCK_NB);
  } while (result != 0 && errno == EINTR);
  return result == 0 ? 0 : errno;
}
}  // namespace

int createGrowingFile(const std::string& path)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
  {
    throw UserError(path + ": is a folder, give the name of a file");
  }
  if (isGrowing(path))
  {
    throw UserError(path +
                    ": another program is recording it; stop that one, or choose another "
                    "--output");
  }
  // Locked before it has its name: an earlier file stays if that fails, and readers of the name
  // meet only a file that grows.
  const std::string unnamed = path + "." + std::to_string(::getpid()) + ".tmp";
  std::filesystem::remove(unnamed, ignored);  // of a killed program with the same number
  const int descriptor = ::open(unnamed.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0)
  {
    throw UserError(path + ": cannot be written: " + std::strerror(errno));
  }
  const auto fail = [&](const std::string& message)
  {
    ::close(descriptor);
    std::filesystem::remove(unnamed, ignored);
    throw UserError(path + message);
  };
  if (const int reason = tryLock(descriptor, LOCK_EX); reason != 0)
  {
    fail(std::string(": cannot be locked: ") + std::strerror(reason) +
         "; choose an --output on another file system");
  }
  if (std::rename(unnamed.c_str(), path.c_str()) != 0)
  {
    fail(std::string(": cannot be written: ") + std::strerror(errno));
  }
  return descriptor;
}

bool isGrowing(int descriptor)
{
  const int reason = tryLock(descriptor, LOCK_SH);
  if (reason == 0)
  {
    ::flock(descriptor, LOCK_UN);
  }
  return reason == EWOULDBLOCK;  // other reasons: the file system has no locks
}

bool isGrowing(const std::string& path)
{
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
  {
    return false;
  }
  const bool grows = isGrowing(descriptor);
  ::close(descriptor);
  return grows;
}
}  // namespace dyslam
