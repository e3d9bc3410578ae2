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
/** Those of the files that exist. */
std::vector<std::string> existing(const std::vector<fs::path>& files)
{
  std::vector<std::string> found;
  for (const fs::path& file : files)
  {
    std::error_code unreadable;
    if (fs::is_regular_file(file, unreadable))
    {
      found.push_back(file.string());
    }
  }
  return found;
}

/** The files of times of a folder of scans: in the nearest place that has any. */
std::vector<std::string> timeFilesOf(const fs::path& scans)
{
  const fs::path above = scans.parent_path();
  for (const std::vector<fs::path>& place :
       {std::vector<fs::path>{scans / "times.txt", scans / "timestamps.txt"},
        std::vector<fs::path>{above / "times.txt", above / "timestamps.txt"},
        std::vector<fs::path>{above.parent_path() / "times" /
                              (scans.filename().string() + ".txt")}})
  {
    if (std::vector<std::string> found = existing(place); !found.empty())
    {
      return found;
    }
  }
  return {};
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
  const std::vector<std::string> files = timeFilesOf(of_scans);
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
