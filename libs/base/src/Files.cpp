// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <system_error>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Advice as the end of an error message; empty if there is none. */
std::string hintOf(const std::string& advice)
{
  return advice.empty() ? "" : "; " + advice;
}

/** Whether a file of a Git repository was not downloaded, but stands for one in Git LFS. */
bool isLfsPointer(const fs::path& path, std::ifstream& file)
{
  constexpr std::uintmax_t largest = 1023;  // [bytes]
  constexpr std::string_view begin = "version https://git-lfs.github.com/spec/";
  std::error_code unknown_size;
  if (!fs::is_regular_file(path, unknown_size) || fs::file_size(path, unknown_size) > largest ||
      unknown_size)
  {
    return false;
  }
  std::string start(begin.size(), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  file.clear();
  file.seekg(0);
  return start == begin;
}

/** Absolute path; links are followed in its existing part. */
fs::path resolved(const std::string& path)
{
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  fs::path canonical = fs::weakly_canonical(absolute, error);
  return error ? absolute.lexically_normal() : canonical;
}

/** Entries of a folder, by name. \param error set if the folder can't be read to its end */
std::vector<fs::directory_entry> readEntries(const fs::path& folder, std::error_code& error)
{
  std::vector<fs::directory_entry> entries;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
  {
    entries.push_back(*it);
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}
}  // namespace

std::ifstream openBinary(const std::string& path, const std::string& advice)
{
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::status_known(status))  // for example without permission to search a parent folder
  {
    throw UserError(path + ": cannot be read: " + error.message());
  }
  if (!fs::exists(status))
  {
    throw UserError(path + ": no such file" + hintOf(advice));
  }
  if (fs::is_directory(status))
  {
    throw UserError(path + ": is a folder, a file is needed" + hintOf(advice));
  }
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file)
  {
    throw UserError(path +
                    ": cannot be read: " + (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
  if (isLfsPointer(path, file))
  {
    throw UserError(path + ": is a Git LFS pointer, not the file itself; run 'git lfs pull' there");
  }
  return file;
}

void requireReadable(const std::istream& file, const std::string& path)
{
  if (file.bad())
  {
    throw UserError(path + ": cannot be read to its end: " +
                    (errno != 0 ? std::strerror(errno) : "unknown reason") +
                    "; check the disk, or copy the file again");
  }
}

std::string readWhole(const std::string& path, const std::string& advice)
{
  std::ifstream file = openBinary(path, advice);
  std::string content;
  std::error_code unknown_size;
  const auto size = fs::file_size(path, unknown_size);
  content.reserve(unknown_size ? 0 : static_cast<std::size_t>(size));
  std::vector<char> block(std::size_t{1} << 16U);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
  {
    content.append(block.data(), static_cast<std::size_t>(file.gcount()));
  }
  requireReadable(file, path);
  return content;
}

std::string nameOfFile(const std::string& path)
{
  const fs::path normal = fs::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal : normal.parent_path()).filename().string();
}

bool isSamePath(const std::string& a, const std::string& b)
{
  std::error_code ignored;
  return fs::equivalent(a, b, ignored) || (!a.empty() && resolved(a) == resolved(b));
}

bool isWithin(const std::string& path, const std::string& folder)
{
  const fs::path relative = resolved(path).lexically_relative(resolved(folder));
  return !relative.empty() && *relative.begin() != "..";
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

bool isFolder(const fs::path& path)
{
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

std::vector<fs::directory_entry> entriesOf(const fs::path& folder)
{
  std::error_code error;
  auto entries = readEntries(folder, error);
  if (error)
  {
    throw UserError(folder.string() + ": cannot be read: " + error.message());
  }
  return entries;
}

std::vector<fs::directory_entry> entriesIfReadable(const fs::path& folder)
{
  std::error_code ignored;
  return readEntries(folder, ignored);
}

std::vector<std::string> foldersIn(const fs::path& folder)
{
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : entriesOf(folder))
  {
    std::error_code ignored;
    if (entry.is_directory(ignored))
    {
      names.push_back(entry.path().filename().string());
    }
  }
  return names;
}
}  // namespace dyslam
