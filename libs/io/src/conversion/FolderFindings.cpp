// SPDX-License-Identifier: BSD-3-Clause
#include "FolderFindings.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "NameStamps.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Warns if the files are taken as `dt` apart, though numbers are missing between them. */
void warnAboutGaps(const std::vector<std::string>& files, double dt, ScanSink& sink)
{
  const std::vector<int> numbers = numbersFromNames(files);
  const auto gap =
      std::adjacent_find(numbers.begin(), numbers.end(), [](int a, int b) { return b - a > 1; });
  if (gap == numbers.end())
  {
    return;
  }
  const auto before = static_cast<std::size_t>(gap - numbers.begin());
  sink.warn("file numbers have gaps: " + fs::path(files[before + 1]).filename().string() +
            " follows " + fs::path(files[before]).filename().string() + "; scans are taken as " +
            secondsText(dt) +
            " s apart (--by-number of scans2rawlog takes their times from their numbers)");
}

/** Warns if the folder of the scans is part of a KITTI recording. */
void warnAboutKitti(const std::string& input, ScanSink& sink)
{
  const fs::path folder = fs::absolute(fs::path(input) / "").lexically_normal().parent_path();
  const bool is_data = folder.filename() == "data";
  const fs::path recording = is_data ? folder.parent_path().parent_path() : folder.parent_path();
  const fs::path scans = is_data ? "velodyne_points/data" : "velodyne";
  const std::optional<KittiKind> kind = officialKittiKind(recording.string());
  if (!kind || recording / scans != folder)
  {
    return;
  }
  sink.warn("the scans are those of a KITTI recording; give its folder, -i " +
            shellWord(recording.string()) + ", for its true poses" +
            (*kind == KittiKind::odometry ? ", and because its scans are already deskewed" : ""));
}
}  // namespace

void FolderFindings::add(const Scan& scan, bool has_stamp, const std::string& file)
{
  assumed_times = assumed_times || !has_stamp;
  if (first_with_points.empty() && scan.size() > 0)
  {
    first_with_points = file;
    constexpr float highest = 65535;  // of 16 bits
    const auto odd =
        std::count_if(scan.intensity.begin(), scan.intensity.end(),
                      [](float intensity) { return !(intensity >= 0 && intensity <= highest); });
    odd_intensities = static_cast<double>(odd) / static_cast<double>(scan.size());
    lengths = lengthsOf(scan);
    if (lengths.areTooFar())
    {
      throw UserError(file + ": half of its points are more than 100 km from the origin: " +
                      (lowerExtension(file) == ".bin"
                           ? "its columns are probably not x y z intensity (float32), or not "
                             "relative to the lidar; --bin-layout names its columns, a letter each"
                           : "its coordinates are not relative to the lidar; subtract an origin"));
    }
  }
  if (scan.size() == 0)
  {
    first_empty = empty == 0 ? fs::path(file).filename().string() : first_empty;
    ++empty;
  }
}

void warnAbout(const FolderFindings& findings,
               const std::string& input,
               const std::vector<std::string>& files,
               const ScanConverterOptions& options,
               ScanSink& sink)
{
  if (findings.assumed_times)
  {
    warnAboutGaps(files, options.dt > 0 ? options.dt : assumed_dt, sink);
  }
  if (findings.empty > 0)
  {
    sink.warn(counted(findings.empty, "file") + " without points, the first is " +
              findings.first_empty + ": empty scans are written");
  }
  constexpr double many = 0.05;
  if (findings.odd_intensities > many && lowerExtension(findings.first_with_points) == ".bin")
  {
    sink.warn(fs::path(findings.first_with_points).filename().string() + ": " +
              std::to_string(std::lround(100 * findings.odd_intensities)) +
              " % of the intensities are negative, above 65535 or no numbers: its columns are "
              "probably not x y z intensity (float32); --bin-layout names them, a letter each");
  }
  if (const std::string warning = findings.lengths.warning(options.scale); !warning.empty())
  {
    sink.warn(fs::path(findings.first_with_points).filename().string() + ": " + warning);
  }
  warnAboutKitti(input, sink);
}
}  // namespace dyslam
