// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Words.h>

#include <filesystem>
#include <map>
#include <vector>

#include "ProgramFolders.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** \throws UserError if $DYSLAM_SHARE names no folder: the files of another version would be used.
 */
std::vector<fs::path> sharedFolders()
{
  const std::string given = environmentValue("DYSLAM_SHARE");
  std::error_code ignored;
  if (!given.empty() && !fs::is_directory(given, ignored))
  {
    throw UserError("DYSLAM_SHARE = " + given +
                    ": is not a folder; set it to the folder share/dyslam, or unset it");
  }
  return ProgramFolders{"DYSLAM_SHARE", DYSLAM_SOURCE_SHARE, fs::path("share") / "dyslam",
                        DYSLAM_INSTALLED_SHARE}
      .candidates();
}

bool isFor(const std::string& ini, const std::string& program)
{
  try
  {
    Config::fromFile(ini).requireFor(program);
    return true;
  }
  catch (const UserError&)
  {
    return false;
  }
}

std::string namesIn(const std::string& folder,
                    const std::string& extension,
                    const std::string& program)
{
  std::string text;
  for (const auto& path : sharedFiles(folder, extension))
  {
    if (!program.empty() && !isFor(path, program))
    {
      continue;
    }
    appendWord(text, fs::path(path).filename().string());
  }
  return text;
}

/** The shared file of this name, with or without the extension; empty if there is none, and for a
 * path. */
std::string sharedFile(const std::string& name,
                       const std::string& folder,
                       const std::string& extension)
{
  if (name.find('/') != std::string::npos)
  {
    return "";
  }
  for (const auto& shared : sharedFolders())
  {
    for (const auto& file : {name, name + extension})
    {
      if (fs::is_regular_file(shared / folder / file))
      {
        return (shared / folder / file).string();
      }
    }
  }
  return "";
}

/** Where weights are that the Debian package of the programs does not contain, to follow a message;
 * empty for other files. They are listed in cmake/DySLAMInstall.cmake, too. */
std::string packageWith(const std::string& path, const std::string& extension)
{
  const bool is_in_weights =
      extension == ".safetensors" && (path == "dylo" || path == "dylo.safetensors" ||
                                      path == "dyseg" || path == "dyseg.safetensors");
  return is_in_weights ? "; of the Debian packages, dyslam-weights-noncommercial has these "
                         "weights (for non-commercial use only)"
                       : "";
}
}  // namespace

std::vector<std::string> sharedFiles(const std::string& folder, const std::string& extension)
{
  std::map<std::string, std::string> by_name;
  for (const auto& shared : sharedFolders())
  {
    for (const auto& entry : entriesIfReadable(shared / folder))
    {
      if (entry.path().extension() == extension)
      {
        by_name.emplace(entry.path().filename().string(), entry.path().string());
      }
    }
  }
  std::vector<std::string> paths;
  for (const auto& [name, path] : by_name)
  {
    paths.push_back(path);
  }
  return paths;
}

std::string searchedFolders()
{
  std::string text;
  for (const fs::path& folder : sharedFolders())
  {
    appendWord(text, folder.lexically_normal().string());
  }
  return text;
}

std::string findGivenOrShared(const std::string& path,
                              const std::string& folder,
                              const std::string& extension,
                              const std::string& field,
                              const std::string& program)
{
  if (fs::is_regular_file(path))
  {
    return path;
  }
  if (std::string shared = sharedFile(path, folder, extension); !shared.empty())
  {
    return shared;
  }
  const std::string known = namesIn(folder, extension, program);
  const bool lacks_shared = path.find('/') == std::string::npos && known.empty() &&
                            sharedFiles(folder, extension).empty();
  throw UserError((field.empty() ? "" : field + " = ") + (path.empty() ? "(nothing)" : path) +
                  (fs::is_directory(path) ? ": is a folder" : ": no such file") +
                  (known.empty() ? "" : "; give a path or one of: " + known) +
                  (lacks_shared ? "; if it is a shipped one: set DYSLAM_SHARE to the folder "
                                  "share/dyslam"
                                : "") +
                  packageWith(path, extension));
}

std::string sharedInsteadOf(const std::string& path,
                            const std::string& folder,
                            const std::string& extension,
                            const std::string& field)
{
  if (path.empty() || fs::is_regular_file(path))
  {
    return "";
  }
  const std::string shared = sharedFile(path, folder, extension);
  const bool has_file = fs::is_regular_file(path + extension);
  if (shared.empty() || (!has_file && !fs::is_directory(path)))
  {
    return "";
  }
  return field + " = " + path + ": is the name of shipped ones, " + shared + ", which are used; " +
         (has_file ? "give ./" + path + extension + " for the file of this folder"
                   : "the folder " + path + " is not: give a file in it with its path");
}
}  // namespace dyslam
