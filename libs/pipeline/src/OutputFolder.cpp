// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFolder.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
constexpr const char* advice = "choose another --output";

std::vector<fs::path> filesIn(const fs::path& folder)
{
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
  {
    files.push_back(it->path());
  }
  return files;
}

bool isNumbered(const fs::path& file, const std::string& extension)
{
  const std::string stem = file.stem().string();
  return file.extension() == extension && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/** With what a run that was killed left of it; nothing happens where it is not there. */
void removeFile(const fs::path& file)
{
  std::error_code ignored;
  fs::remove(file, ignored);
  fs::remove(file.string() + ".tmp", ignored);
}

void removeNumbered(const fs::path& folder, const std::string& extension)
{
  for (fs::path file : filesIn(folder))
  {
    if (file.extension() == ".tmp")
    {
      file.replace_extension();
    }
    if (isNumbered(file, extension))
    {
      removeFile(file);
    }
  }
  std::error_code ignored;
  fs::remove(folder, ignored);  // only if it is empty now
}
}  // namespace

void prepareOutputFolder(const std::string& folder,
                         const std::vector<OutputName>& names,
                         const std::string& input)
{
  const fs::path base = folder;
  makeFolder(folder, advice);
  const bool of_a_run = fs::exists(base / "effective.ini");
  for (const OutputName& name : names)
  {
    std::error_code ignored;
    if (fs::equivalent(input, base / name.name, ignored))
    {
      throw UserError(input + ": would be replaced by this run's " + name.name + "; " + advice);
    }
    if (!name.extension.empty() && !of_a_run && !filesIn(base / name.name).empty())
    {
      throw UserError((base / name.name).string() + ": holds files that are of no run; " + advice);
    }
  }
  for (auto name = names.rbegin(); name != names.rend(); ++name)
  {
    if (name->extension.empty())
    {
      removeFile(base / name->name);
    }
    else
    {
      removeNumbered(base / name->name, name->extension);
    }
  }
}
}  // namespace dyslam
