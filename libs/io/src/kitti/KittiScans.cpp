// SPDX-License-Identifier: BSD-3-Clause
#include "KittiScans.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/OptionError.h>

#include <algorithm>
#include <iterator>
#include <limits>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
bool allDigits(const std::string& text)
{
  return !text.empty() && text.size() < 12 &&
         text.find_first_not_of("0123456789") == std::string::npos;
}

bool hasScans(const fs::path& folder)
{
  if (!isFolder(folder))
  {
    return false;
  }
  const auto files = entriesOf(folder);
  return std::any_of(files.begin(), files.end(),
                     [](const auto& entry) { return entry.path().extension() == ".bin"; });
}

/** Names of the folders in a folder that `wanted` takes, sorted; none if it is not there. */
template <typename Wanted>
std::vector<std::string> foldersThat(const Wanted& wanted, const fs::path& folder)
{
  std::vector<std::string> names;
  if (isFolder(folder))
  {
    const std::vector<std::string> all = foldersIn(folder);
    std::copy_if(all.begin(), all.end(), std::back_inserter(names), wanted);
  }
  return names;
}

void requireKind(const std::string& input, KittiKind kind)
{
  const auto found = officialKittiKind(input);
  if (found && *found != kind)
  {
    throw OptionError(input + ": has the layout of KITTI " + toString(*found) + "; use --kind " +
                          toString(*found),
                      "--kind");
  }
}

/** The folder that was probably meant, with the text that leads to it. */
std::string nearbyRecording(const fs::path& input)
{
  for (const fs::path& root : {input / "sequences", input / "dataset" / "sequences"})
  {
    const auto sequences = foldersThat(
        [&root](const std::string& name) { return hasScans(root / name / "velodyne"); }, root);
    if (!sequences.empty())
    {
      return "; give one of its sequences, such as --kind odometry -i " +
             (root / sequences.front()).string();
    }
  }
  const auto drives = foldersThat([&input](const std::string& name)
                                  { return hasScans(input / name / "velodyne_points" / "data"); },
                                  input);
  if (!drives.empty())
  {
    return "; give one of its drives, such as --kind raw -i " + (input / drives.front()).string();
  }
  for (const char* part : {"training", "testing"})
  {
    if (officialKittiKind((input / part).string()) == KittiKind::tracking)
    {
      return "; give --kind tracking -i " + (input / part).string();
    }
  }
  return "";
}

std::string findSequence(const fs::path& input, const std::string& asked)
{
  if (!asked.empty() || hasScans(input / "velodyne"))
  {
    return asked;
  }
  const auto names = foldersThat(allDigits, input / "velodyne");
  if (names.size() > 1)
  {
    throw OptionError(input.string() + ": holds " + std::to_string(names.size()) +
                          " sequences; choose one with --sequence, such as " + names.front(),
                      "--sequence");
  }
  return names.empty() ? "" : names.front();
}

/** File names are frame numbers, with gaps where KITTI lost a scan; else they are just counted.
 * \throws UserError for numbers that are too large for those of boxes. */
void numberScans(std::vector<KittiLayout::Entry>& entries)
{
  constexpr std::size_t largest = std::numeric_limits<int>::max();
  const bool named =
      std::all_of(entries.begin(), entries.end(),
                  [](const auto& entry) { return allDigits(fs::path(entry.scan).stem()); });
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    entries[i].number = named ? std::stoull(fs::path(entries[i].scan).stem().string()) : i;
    if (entries[i].number > largest)
    {
      throw UserError(entries[i].scan + ": the number in its name is too large, " +
                      std::to_string(largest) + " is the largest; rename the scans");
    }
    if (i > 0 && entries[i].number <= entries[i - 1].number)
    {
      throw UserError(entries[i].scan + ": has the same number as " + entries[i - 1].scan);
    }
  }
}
}  // namespace

KittiScans findKittiScans(const fs::path& input, const KittiConverterOptions& options)
{
  requireKind(input.string(), options.kind);
  KittiScans scans;
  std::vector<fs::path> candidates;
  if (options.kind == KittiKind::raw)
  {
    candidates.push_back(input / "velodyne_points" / "data");
  }
  if (options.kind == KittiKind::tracking && fs::is_directory(input / "velodyne"))
  {
    scans.sequence = findSequence(input, options.sequence);
    candidates.push_back(input / "velodyne" / scans.sequence);
  }
  candidates.push_back(input / "velodyne");
  candidates.push_back(input);
  const auto found = std::find_if(candidates.begin(), candidates.end(), hasScans);
  if (found == candidates.end())
  {
    const std::string what = input.string() + ": has no scans (looked for .bin files in " +
                             candidates.front().string() + ")";
    const std::string nearby = nearbyRecording(input);
    if (!nearby.empty())
    {
      throw OptionError(what + nearby, "--kind");
    }
    throw UserError(what);
  }
  for (const std::string& file : listCloudFiles(found->string()))
  {
    KittiLayout::Entry entry;
    entry.scan = file;
    scans.entries.push_back(entry);
  }
  numberScans(scans.entries);
  return scans;
}
}  // namespace dyslam
