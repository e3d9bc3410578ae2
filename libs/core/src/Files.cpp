// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::string hintOf(const std::string& advice)
{
  return advice.empty() ? "" : "; " + advice;
}
}  // namespace

std::ifstream openBinary(const std::string& path, const std::string& advice)
{
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status))
  {
    throw UserError(path + ": no such file" + hintOf(advice));
  }
  if (fs::is_directory(status))
  {
    throw UserError(path + ": is a folder, a file is needed" + hintOf(advice));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    throw UserError(path + ": cannot be read: " + std::strerror(errno));
  }
  return file;
}

std::string readWhole(const std::string& path, const std::string& advice)
{
  std::ifstream file = openBinary(path, advice);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

void makeFolder(const std::string& path, const std::string& advice)
{
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path))
  {
    throw UserError(path + ": cannot make this folder" +
                    (error ? ": " + error.message() : std::string(": a file is in the way")) +
                    hintOf(advice));
  }
}
}  // namespace dyslam
