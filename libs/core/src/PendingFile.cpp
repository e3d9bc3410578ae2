// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyslam
{
namespace fs = std::filesystem;

PendingFile::PendingFile(const std::string& path) : path_(path), temporary_(path + ".tmp")
{
  std::error_code ignored;
  if (fs::is_directory(path, ignored))
  {
    throw UserError(path + ": is a folder, give the name of a file");
  }
}

PendingFile::~PendingFile()
{
  if (!committed_)
  {
    std::error_code ignored;
    fs::remove(temporary_, ignored);
  }
}

void PendingFile::commit()
{
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error)
  {
    throw UserError(path_ + ": cannot be written: " + error.message());
  }
  committed_ = true;
}

void writeWhole(const std::string& path, const std::function<void(std::ostream&)>& write)
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
  pending.commit();
}

void writeWhole(const std::string& path, std::string_view content)
{
  writeWhole(path, [content](std::ostream& out)
             { out.write(content.data(), static_cast<std::streamsize>(content.size())); });
}
}  // namespace dyslam
