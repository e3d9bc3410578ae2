// SPDX-License-Identifier: BSD-3-Clause
#include "FoundTimes.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/KittiFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <system_error>

#include "NameStamps.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::vector<std::string> timeFilesIn(const fs::path& folder)
{
  std::vector<std::string> files;
  for (const char* name : {"times.txt", "timestamps.txt"})
  {
    std::error_code unreadable;
    if (fs::is_regular_file(folder / name, unreadable))
    {
      files.push_back((folder / name).string());
    }
  }
  return files;
}

/** Why times cannot be those of the scans; empty if they can. */
std::string whyUnfit(const std::vector<double>& stamps, std::size_t scans)
{
  if (stamps.size() != scans)
  {
    return "it has " + counted(stamps.size(), "time") + ", but there are " + counted(scans, "scan");
  }
  const bool ascend = std::adjacent_find(stamps.begin(), stamps.end(),
                                         std::greater_equal<double>()) == stamps.end();
  return ascend ? "" : "its times do not ascend";
}
}  // namespace

std::vector<double> readTimesOfScans(const std::string& file)
{
  std::vector<double> stamps = readTimesOrTimestamps(file);
  stamps.erase(
      std::remove_if(stamps.begin(), stamps.end(), [](double stamp) { return std::isnan(stamp); }),
      stamps.end());
  std::transform(stamps.begin(), stamps.end(), stamps.begin(), secondsOf);
  return stamps;
}

FoundTimes findTimes(const std::string& folder, std::size_t scans)
{
  const fs::path of_scans = fs::absolute(fs::path(folder) / "").lexically_normal().parent_path();
  std::vector<std::string> files = timeFilesIn(of_scans);
  files = files.empty() ? timeFilesIn(of_scans.parent_path()) : files;
  FoundTimes found;
  if (files.size() > 1)
  {
    found.why_unused = files[0] + " and " + fs::path(files[1]).filename().string() +
                       " are not used: either may have the times of the scans";
  }
  if (files.size() != 1)
  {
    return found;
  }
  try
  {
    found.stamps = readTimesOfScans(files[0]);
    found.why_unused = whyUnfit(found.stamps, scans);
  }
  catch (const UserError& error)
  {
    found.why_unused = error.what();
  }
  if (found.why_unused.empty())
  {
    found.file = files[0];
  }
  else
  {
    found.stamps.clear();
    found.why_unused = files[0] + " is not used: " + found.why_unused;
  }
  return found;
}
}  // namespace dyslam
