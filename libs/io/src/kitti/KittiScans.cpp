// SPDX-License-Identifier: BSD-3-Clause
#include "KittiScans.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
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
constexpr const char* drives_of_360 = "data_3d_raw";

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

/** Names of the drives of KITTI raw or KITTI-360 in a folder, sorted. */
std::vector<std::string> drivesIn(const fs::path& folder)
{
  return foldersThat([&folder](const std::string& name)
                     { return hasScans(folder / name / "velodyne_points" / "data"); },
                     folder);
}

void requireKind(const std::string& input, KittiKind kind)
{
  const auto found = officialKittiKind(input);
  // Drives of KITTI-360 are known by their name, which a user may have changed; raw's have oxts.
  const bool is_renamed =
      found == KittiKind::raw && kind == KittiKind::kitti360 && !isFolder(fs::path(input) / "oxts");
  if (found && *found != kind && !is_renamed)
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
             shellWord((root / sequences.front()).string());
    }
  }
  for (const fs::path& root : {input, input / drives_of_360})
  {
    const auto drives = drivesIn(root);
    if (!drives.empty())
    {
      const std::string drive = (root / drives.front()).string();
      const KittiKind kind = officialKittiKind(drive).value_or(KittiKind::raw);
      return "; give one of its drives, such as --kind " + toString(kind) + " -i " +
             shellWord(drive);
    }
  }
  for (const char* part : {"training", "testing"})
  {
    if (officialKittiKind((input / part).string()) == KittiKind::tracking)
    {
      return "; give --kind tracking -i " + shellWord((input / part).string());
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

/** Whether a drive of KITTI-360 is the one that `asked` names, by its folder or its number. */
bool isDrive(const std::string& name, const std::string& asked)
{
  return name == asked || name == "2013_05_28_drive_" + asked + "_sync";
}

/** The folder of a drive: `input`, or the one in its `data_3d_raw` or in itself that is asked for.
 * The input if it has no drives. */
fs::path findDrive(const fs::path& input, const std::string& asked)
{
  if (hasScans(input / "velodyne_points" / "data"))
  {
    const std::string name = nameOfFile(input);
    if (!asked.empty() && !isDrive(name, asked))
    {
      throw OptionError(input.string() + ": is the folder of a drive, not of " + asked +
                            "; leave --sequence out, or give the folder of all drives with -i",
                        "--sequence");
    }
    return input;
  }
  const fs::path root = isFolder(input / drives_of_360) ? input / drives_of_360 : input;
  const std::vector<std::string> drives = drivesIn(root);
  std::vector<std::string> matching = drives;
  if (!asked.empty())
  {
    matching.erase(
        std::remove_if(matching.begin(), matching.end(),
                       [&asked](const std::string& name) { return !isDrive(name, asked); }),
        matching.end());
  }
  if (matching.size() == 1)
  {
    return root / matching.front();
  }
  if (drives.empty())
  {
    return input;
  }
  throw OptionError(root.string() +
                        (asked.empty() ? ": holds " + std::to_string(drives.size()) + " drives"
                                       : ": has no scans of drive " + asked) +
                        "; choose one with --sequence, such as " + drives.front(),
                    "--sequence");
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

KittiScans findKittiScans(const fs::path& given, const KittiConverterOptions& options)
{
  requireKind(given.string(), options.kind);
  KittiScans scans;
  scans.folder = options.kind == KittiKind::kitti360 ? findDrive(given, options.sequence) : given;
  const fs::path& input = scans.folder;
  std::vector<fs::path> candidates;
  if (options.kind == KittiKind::raw || options.kind == KittiKind::kitti360)
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

std::vector<std::size_t> linesOfScans(const std::vector<KittiLayout::Entry>& entries,
                                      const std::string& path,
                                      std::size_t count,
                                      const std::string& what)
{
  const std::size_t last = entries.back().number;
  const bool by_number = count > last;
  const bool counts_from_0 = last + 1 == entries.size();  // line and number are the same
  if (!by_number && !counts_from_0 && count != entries.size())
  {
    throw UserError(path + ": has " + counted(count, what) + ", but there are " +
                    counted(entries.size(), "scan") + ", numbered from " +
                    std::to_string(entries.front().number) + " to " + std::to_string(last) +
                    "; a " + what + " for each scan or for each number is needed");
  }
  std::vector<std::size_t> lines;
  for (std::size_t i = 0; i < entries.size(); ++i)
  {
    lines.push_back(by_number ? entries[i].number : i);
  }
  return lines;
}
}  // namespace dyslam
