// SPDX-License-Identifier: BSD-3-Clause
#include "FirstPass.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PathSettings.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <vector>

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
fs::path labelsOfFirstPass(const std::string& output)
{
  return fs::path(output) / "first_pass" / run_files::labels;
}

/** Only the label files in a folder, which may have files of the user, too. */
std::vector<fs::path> labelFilesIn(const fs::path& folder)
{
  std::vector<fs::path> files;
  for (const auto& entry : entriesOf(folder))
  {
    if (entry.path().extension() == ".label")
    {
      files.push_back(entry.path());
    }
  }
  return files;
}
}  // namespace

RunRequest firstPassOf(const RunRequest& request)
{
  RunRequest first = request;
  first.passes = 1;
  first.settings.labels = true;
  first.settings.probabilities = false;
  first.settings.static_scans = false;
  first.settings.profile_csv.clear();
  for (const char* unused :
       {"pipeline.mapping", "pipeline.hindsight_tracking", "output.replay", "output.simplemap",
        "output.pcd", "output.ply", "output.scene", "output.plot", "output.page"})
  {
    first.assignments.push_back(std::string(unused) + "=false");
  }
  first.assignments.emplace_back("output.checkpoint_seconds=0");
  return first;
}

std::string labelsIn(const Config& config)
{
  return config.text("dyseg", "labels").value_or("");
}

bool isSecondPass(const Config& config, const std::string& output)
{
  std::error_code none;
  const std::string labels = labelsIn(config);
  return !labels.empty() && fs::equivalent(labels, labelsOfFirstPass(output), none);
}

std::string keptLabelsOf(const std::string& output)
{
  return absolutePath(labelsOfFirstPass(output).string());
}

std::string keepLabelsOfFirstPass(const std::string& output)
{
  const fs::path kept = labelsOfFirstPass(output);
  const fs::path made = fs::path(output) / run_files::labels;
  try
  {
    for (const fs::path& folder : {kept.parent_path(), kept})
    {
      if (fs::is_symlink(folder))
      {
        throw UserError(folder.string() + ": is a link; remove it, or choose another --output");
      }
    }
    fs::create_directories(kept);
    for (const fs::path& earlier : labelFilesIn(kept))
    {
      fs::remove(earlier);
    }
    for (const fs::path& label : labelFilesIn(made))
    {
      fs::rename(label, kept / label.filename());
    }
    std::error_code ignored;
    fs::remove(made, ignored);  // succeeds only if the folder is empty
  }
  catch (const fs::filesystem_error& error)
  {
    throw UserError(kept.string() + ": cannot be written (" + error.code().message() +
                    "); choose another --output");
  }
  return keptLabelsOf(output);
}

std::string comparePaths(double first, double second)
{
  constexpr double max_ratio = 0.1;     // largest difference relative to the longer path
  constexpr double max_difference = 1;  // difference that is ignored, for standing vehicles [m]
  if (std::abs(first - second) <= std::max(max_difference, max_ratio * std::max(first, second)))
  {
    return "";
  }
  return formatted(
      "the path is %.1f m long, that of the first pass %.1f m: in one of them scans may have been "
      "registered to moving objects; check trajectory and map",
      second, first);
}
}  // namespace dyslam
