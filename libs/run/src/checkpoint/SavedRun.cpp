// SPDX-License-Identifier: BSD-3-Clause
#include "SavedRun.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/core/Version.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "../FirstPass.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
template <typename T>
std::string_view bytesOf(const std::vector<T>& values)
{
  return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
}

std::unique_ptr<OutputFolder> lockedFolder(const std::string& folder)
{
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
  {
    throw UserError(folder + ": no such folder; --output names the folder of the run to resume");
  }
  if (!fs::is_regular_file(fs::path(folder) / state_file_name, ignored))
  {
    throw UserError(folder + ": nothing to resume: there is no " + state_file_name +
                    "; the run has ended, or has no checkpoint yet "
                    "(output.checkpoint_seconds)");
  }
  return std::make_unique<OutputFolder>(folder);
}
}  // namespace

RunToResume::RunToResume(const std::string& folder)
    : lock(lockedFolder(folder)), file((fs::path(folder) / state_file_name).string(), state_parts)
{
  load(StatePart::run, [this](StateArchive& archive) { archive(run); });
  if (run.version != DYSLAM_VERSION)
  {
    throw UserError((fs::path(folder) / state_file_name).string() + ": is of DySLAM " +
                    run.version + ", this is " + DYSLAM_VERSION +
                    "; resume with that one, or start the run anew");
  }
  if (run.is_second_pass)
  {
    const std::string name = "the state's settings";
    Config settings = Config::fromText(run.settings, name);
    settings.set("dyseg", "labels", {keptLabelsOf(folder), name, {}});
    run.settings = settings.toIni();
  }
}

void ScanSum::add(const Frame& frame)
{
  const Scan& scan = frame.scan;
  const auto number = [](const auto& value)
  { return std::string_view(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const std::string_view bytes :
       {number(frame.index), number(scan.stamp), bytesOf(scan.points), bytesOf(scan.intensity),
        bytesOf(scan.time), bytesOf(scan.ring)})
  {
    sum_ = checksum(bytes, sum_);
  }
  ++scans_;
}

bool Checkpoints::due(bool at_once)
{
  constexpr double share = 0.05;  // largest share of the run time for checkpoints
  const auto now = std::chrono::steady_clock::now();
  const double least = at_once ? 0 : std::max(seconds_, cost_ / share);
  if (seconds_ <= 0 || std::chrono::duration<double>(now - last_).count() < least)
  {
    return false;
  }
  last_ = now;
  return true;
}

void Checkpoints::begin(std::size_t frame, BegunCheckpoint begun)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  begun_[frame] = std::move(begun);
}

std::optional<BegunCheckpoint> Checkpoints::take(std::size_t frame)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = begun_.find(frame);
  if (found == begun_.end())
  {
    return std::nullopt;
  }
  BegunCheckpoint begun = std::move(found->second);
  begun_.erase(found);
  return begun;
}
}  // namespace dyslam
