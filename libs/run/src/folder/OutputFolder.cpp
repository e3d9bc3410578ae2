// SPDX-License-Identifier: BSD-3-Clause
#include "OutputFolder.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RunFiles.h>

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

bool isNumbered(const fs::path& file, const std::string& extension)
{
  const std::string stem = file.stem().string();
  return file.extension() == extension && stem.size() >= 6 &&
         std::all_of(stem.begin(), stem.end(),
                     [](unsigned char c) { return std::isdigit(c) != 0; });
}

/** Removes a file and its temporary file of a killed run; no error if there is none. */
void removeFile(const fs::path& file)
{
  std::error_code ignored;
  fs::remove(file, ignored);
  fs::remove(file.string() + ".tmp", ignored);
}

void removeNumbered(const fs::path& folder, const std::string& extension)
{
  for (const auto& entry : entriesIfReadable(folder))
  {
    fs::path file = entry.path();
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
  fs::remove(folder, ignored);  // succeeds only if the folder is empty
}

bool isLink(const fs::path& path)
{
  std::error_code ignored;
  return fs::is_symlink(fs::symlink_status(path, ignored));
}

/** Whether a folder is one of a run: it has the settings of a run. */
bool isOfARun(const fs::path& folder)
{
  const fs::path settings = folder / run_files::settings;
  std::error_code ignored;
  return fs::is_regular_file(fs::symlink_status(settings, ignored)) &&
         readWhole(settings.string()).find("[output]") != std::string::npos;
}

/** Whether a file or non-empty folder of that name exists. */
bool isTaken(const fs::path& base, const OutputName& name)
{
  const fs::path path = base / name.name;
  std::error_code ignored;
  return fs::is_directory(path, ignored) ? !entriesIfReadable(path).empty()
                                         : fs::exists(fs::symlink_status(path, ignored));
}

void requireNoInput(const fs::path& base,
                    const std::vector<OutputName>& names,
                    const std::vector<std::string>& inputs)
{
  for (const std::string& input : inputs)
  {
    const std::string folder = fs::absolute(input).parent_path().string();
    for (const OutputName& name : names)
    {
      const std::string output = (base / name.name).string();
      const bool within = !name.extension.empty() && isSamePath(folder, output);
      if (within || isSamePath(input, output))
      {
        throw UserError(input + ": would be replaced by this run's " + name.name + "; " + advice);
      }
    }
  }
}

/** Checks the files to be removed. \throws UserError for a file that no run wrote, or a link. */
void requireOwn(const fs::path& base, const std::vector<OutputName>& names, bool force)
{
  const bool replace = force || isOfARun(base);
  std::string foreign;
  for (const OutputName& name : names)
  {
    const fs::path path = base / name.name;
    std::error_code ignored;
    if (isLink(path) && fs::is_directory(path, ignored))
    {
      throw UserError(path.string() + ": is a link to a folder, whose files would be replaced; " +
                      "remove the link, or " + advice);
    }
    if (!replace && isTaken(base, name))
    {
      appendWord(foreign, name.name);
    }
  }
  if (!foreign.empty())
  {
    throw UserError(base.string() + ": has files that no run wrote and this one would replace (" +
                    foreign + "); " + advice + ", or give --force");
  }
}
}  // namespace

OutputFolder::OutputFolder(const std::string& folder,
                           const std::vector<OutputName>& names,
                           const std::vector<std::string>& inputs,
                           bool force)
    : lock_((makeFolder(folder, advice), folder))
{
  const fs::path base = folder;
  requireNoInput(base, names, inputs);
  requireOwn(base, names, force);
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
