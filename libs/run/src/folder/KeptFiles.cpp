// SPDX-License-Identifier: BSD-3-Clause
#include "KeptFiles.h"

#include <dyslam/base/Files.h>

#include <system_error>

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
std::vector<fs::path> filesWith(const std::string& extension, const fs::path& folder)
{
  std::vector<fs::path> files;
  for (const auto& entry : entriesIfReadable(folder))
  {
    if (entry.path().extension() == extension)
    {
      files.push_back(entry.path());
    }
  }
  return files;
}

std::string keptName(const OutputName& name)
{
  return "resume." + name.name;
}

bool isSameFile(const fs::path& a, const fs::path& b)
{
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}
}  // namespace

OutputName KeptFiles::add(const OutputName& name)
{
  names_.push_back(name);
  OutputName kept = name;
  kept.name = keptName(name);
  return kept;
}

void KeptFiles::keep() const
{
  for (const OutputName& name : names_)
  {
    const fs::path kept = folder_ / keptName(name);
    const std::vector<fs::path> files = filesWith(name.extension, folder_ / name.name);
    if (!files.empty())
    {
      makeFolder(kept.string());
    }
    for (const fs::path& file : files)
    {
      std::error_code error;
      fs::create_hard_link(file, kept / file.filename(), error);
      if (error)  // the file system has no hard links
      {
        fs::copy_file(file, kept / file.filename(), fs::copy_options::overwrite_existing);
      }
    }
  }
}

template <typename Use>
void KeptFiles::forEach(const Use& use) const
{
  for (const OutputName& name : names_)
  {
    const fs::path kept = folder_ / keptName(name);
    for (const fs::path& file : filesWith(name.extension, kept))
    {
      use(file, folder_ / name.name / file.filename());
    }
    std::error_code ignored;
    fs::remove(kept, ignored);  // succeeds only if the folder is empty
  }
}

void KeptFiles::removeUnchanged() const
{
  forEach(
      [](const fs::path& kept, const fs::path& original)
      {
        std::error_code ignored;
        if (isSameFile(kept, original))
        {
          fs::remove(kept, ignored);
        }
      });
}

void KeptFiles::removeAll() const
{
  forEach(
      [](const fs::path& kept, const fs::path& /*original*/)
      {
        std::error_code ignored;
        fs::remove(kept, ignored);
      });
}

void KeptFiles::restore() const
{
  forEach(
      [](const fs::path& kept, const fs::path& original)
      {
        if (isSameFile(kept, original))
        {
          fs::remove(kept);  // same file: rename() would do nothing
        }
        else
        {
          fs::rename(kept, original);
        }
      });
}
}  // namespace dyslam
