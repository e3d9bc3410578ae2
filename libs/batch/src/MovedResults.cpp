// SPDX-License-Identifier: BSD-3-Clause
#include "MovedResults.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <system_error>
#include <vector>

namespace fs = std::filesystem;

namespace dyslam::batch
{
namespace
{
/** A path within the folder `from`, once that is moved to `to`; any other as it is. */
std::string movedPath(const std::string& path, const std::string& from, const std::string& to)
{
  const fs::path relative =
      fs::path(path).lexically_normal().lexically_relative(fs::absolute(from).lexically_normal());
  return relative.empty() || *relative.begin() == ".."
             ? path
             : (fs::absolute(to).lexically_normal() / relative).string();
}

/** Replaces the first `before` in a file by `after`. */
void replaceIn(const fs::path& file, const std::string& before, const std::string& after)
{
  std::string text = readWhole(file.string());
  const std::size_t at = text.find(before);
  if (at != std::string::npos && before != after)
  {
    writeWhole(file.string(), text.replace(at, before.size(), after));
  }
}

/** Copies results, and of an earlier run in `to` all files that these do not replace. */
void copyResults(const fs::path& from, const fs::path& to, const fs::path& copy)
{
  fs::copy(from, copy, fs::copy_options::recursive);
  if (!fs::exists(to))
  {
    return;
  }
  std::vector<std::string> replaced = filesOfRun(to.string());
  replaced.insert(replaced.end(), {log_name, run_files::state});
  for (const auto& entry : fs::directory_iterator(to))
  {
    const fs::path kept = copy / entry.path().filename();
    const std::string name = entry.path().filename().string();
    if (std::find(replaced.begin(), replaced.end(), name) == replaced.end() && !fs::exists(kept))
    {
      fs::copy(entry.path(), kept, fs::copy_options::recursive);
    }
  }
}

/** Waits until what `sync` writes of a folder is on the disk. \param sync `fsync`: the names in the
 * folder; `syncfs`: its whole file system, at once instead of file by file \throws UserError. */
void synchronise(const fs::path& folder, int (*sync)(int))
{
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool done = file >= 0 && (sync(file) == 0 || errno == EINVAL || errno == ENOTSUP);
  const int reason = errno;
  if (file >= 0)
  {
    ::close(file);
  }
  if (!done)
  {
    throw UserError(folder.string() + ": cannot be written: " + std::strerror(reason));
  }
}
}  // namespace

void renameOwnFiles(const std::string& from, const std::string& to)
{
  const fs::path ini = fs::path(from) / run_files::settings;
  if (!fs::exists(fs::path(from) / run_files::report) || !fs::exists(ini))
  {
    return;
  }
  if (const std::string input = runReportIfValid(from).input; !input.empty())
  {
    replaceInput(from, movedPath(input, from, to));
  }
  const Config settings = Config::fromFile(ini.string());
  if (const auto labels = settings.text("dyseg", "labels"))
  {
    replaceIn(ini, *labels, movedPath(*labels, from, to));
  }
}

void moveResults(const fs::path& from, const fs::path& to)
{
  const fs::path partial = to.string() + ".partial";
  fs::remove_all(partial);
  try
  {
    copyResults(from, to, partial);
    synchronise(partial, ::syncfs);
  }
  catch (const std::exception&)
  {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
  const fs::path earlier = to.string() + ".earlier";
  fs::remove_all(earlier);
  if (fs::exists(to))
  {
    fs::rename(to, earlier);
  }
  fs::rename(partial, to);
  synchronise(fs::absolute(to).parent_path(), ::fsync);
  fs::remove_all(earlier);
  fs::remove_all(from);
}

void restoreEarlier(const fs::path& to)
{
  const fs::path earlier = to.string() + ".earlier";
  if (!fs::exists(to) && fs::exists(earlier / log_name))
  {
    fs::rename(earlier, to);
  }
}
}  // namespace dyslam::batch
