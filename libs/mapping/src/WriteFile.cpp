// SPDX-License-Identifier: BSD-3-Clause
#include "WriteFile.h"

#include <dyslam/core/Error.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyslam
{
void renameWritten(const std::string& temporary, const std::string& path)
{
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error)
  {
    throw UserError(path + ": cannot be written (" + error.message() + ")");
  }
}

void writeFile(const std::string& path, const std::function<void(std::ostream&)>& write)
{
  const std::string temporary = path + ".tmp";
  errno = 0;
  std::ofstream file(temporary, std::ios::binary);
  if (file)
  {
    write(file);
    file.close();
  }
  if (!file)
  {
    const std::string reason = errno != 0 ? std::strerror(errno) : "unknown reason";
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw UserError(path + ": cannot be written (" + reason + ")");
  }
  renameWritten(temporary, path);
}
}  // namespace dyslam
