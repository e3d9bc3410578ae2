// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Waits until a file or a folder is on the disk. \return false on failure, with errno set. */
bool synchronised(const std::string& path, int flags)
{
  const int file = ::open(path.c_str(), flags | O_CLOEXEC);
  if (file < 0)
  {
    return false;
  }
  // Some file systems don't support fsync.
  const bool done = ::fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP;
  const int reason = errno;
  ::close(file);
  errno = reason;
  return done;
}
}  // namespace

PendingFile::PendingFile(const std::string& path) : path_(path), temporary_(path + ".tmp")
{
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
  {
    throw UserError(path + ": is a folder, give the name of a file");
  }
  if (fs::is_symlink(fs::symlink_status(temporary_, ignored)) &&
      (fs::is_regular_file(temporary_, ignored) || !fs::exists(temporary_, ignored)))
  {
    fs::remove(temporary_, ignored);  // the link, never what it points to
  }
}

PendingFile::~PendingFile()
{
  if (!committed_ && !kept_)
  {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
}

void PendingFile::commit(Durable durable)
{
  if (durable == Durable::yes && !synchronised(temporary_, O_RDONLY))
  {
    throw UserError(path_ + ": cannot be written: " + std::strerror(errno));
  }
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error)
  {
    throw UserError(path_ + ": cannot be written: " + error.message());
  }
  committed_ = true;
  if (durable == Durable::yes)
  {
    const fs::path folder = fs::path(path_).parent_path();
    (void)synchronised(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY);
  }
}

void writeWhole(const std::string& path,
                const std::function<void(std::ostream&)>& write,
                Durable durable)
{
  PendingFile pending(path);
  errno = 0;
  std::ofstream file(pending.temporary(), std::ios::binary);
  if (file)
  {
    write(file);
    file.close();
  }
  if (!file)
  {
    throw UserError(
        path + ": cannot be written: " + (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
  pending.commit(durable);
}

void writeWhole(const std::string& path, std::string_view content, Durable durable)
{
  writeWhole(
      path,
      [content](std::ostream& out)
      { out.write(content.data(), static_cast<std::streamsize>(content.size())); },
      durable);
}

void cutPending(const PendingFile& pending, std::uint64_t size)
{
  const std::string& path = pending.temporary();
  std::error_code error;
  if (!fs::exists(path, error) && fs::is_regular_file(pending.path(), error))
  {
    fs::rename(pending.path(), path, error);
  }
  error.clear();
  const std::uint64_t found = fs::file_size(path, error);
  if (!error && found < size)
  {
    throw UserError(path + ": has " + std::to_string(found) + " of the " + std::to_string(size) +
                    " bytes that the run had written; it cannot be resumed");
  }
  if (!error)
  {
    fs::resize_file(path, size, error);
  }
  if (error)
  {
    throw UserError(path + ": cannot be resumed: " + error.message());
  }
}
}  // namespace dyslam
