// SPDX-License-Identifier: BSD-3-Clause
#include "SavedRun.h"

#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/base/Version.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "../FirstPass.h"
#include "../settings/PathSettings.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::unique_ptr<OutputFolder> lockedFolder(const std::string& folder)
{
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
  {
    throw UserError(folder + ": no such folder; --output names the folder of the run to resume");
  }
  if (!fs::is_regular_file(fs::path(folder) / run_files::state, ignored))
  {
    throw UserError(folder + ": nothing to resume: there is no " + run_files::state +
                    "; the run has ended, or has no checkpoint yet "
                    "(output.checkpoint_seconds)");
  }
  return std::make_unique<OutputFolder>(folder);
}

/** \throws UserError if an output is requested that the run did not have from its first scan on. */
void requireHad(bool asked, bool had, const std::string& flag)
{
  if (asked && !had)
  {
    throw UserError(flag +
                    ": the run to resume was started without it; leave it out, or start anew");
  }
}
}  // namespace

SavedRun savedRunOf(const SlamRunSettings& settings,
                    const Config& config,
                    const ScanSum& scans,
                    double seconds)
{
  SavedRun run;
  run.version = DYSLAM_VERSION;
  run.rawlog = fs::absolute(settings.rawlog).lexically_normal().string();
  run.rawlog_size = fs::file_size(settings.rawlog);
  run.settings = config.toIni();
  run.is_second_pass = isSecondPass(config, settings.output_folder);
  std::transform(settings.inputs.begin(), settings.inputs.end(), std::back_inserter(run.inputs),
                 absolutePath);
  run.sensor = settings.sensor;
  run.warnings = settings.warnings;
  run.static_scans = settings.static_scans;
  run.labels = settings.labels;
  run.probabilities = settings.probabilities;
  run.scans = scans.scans();
  run.scans_checksum = scans.sum();
  run.seconds = seconds;
  run.first_pass_time = settings.first_pass_time;
  return run;
}

SlamRunSettings settingsOf(const SavedRun& saved, const SlamRunSettings& given)
{
  SlamRunSettings settings = given;
  settings.rawlog = given.rawlog.empty() ? saved.rawlog : given.rawlog;
  settings.config = Config::fromText(saved.settings, "the state's settings");
  settings.config.merge(given.config);
  settings.inputs = saved.inputs;
  settings.sensor = saved.sensor;
  settings.warnings = saved.warnings;
  requireHad(given.static_scans, saved.static_scans, "--static-scans");
  requireHad(given.labels, saved.labels, "--labels");
  requireHad(given.probabilities, saved.probabilities, "--probabilities");
  settings.static_scans = saved.static_scans;
  settings.labels = saved.labels;
  settings.probabilities = saved.probabilities;
  return settings;
}

void requireSameSettings(const SavedRun& saved, const Config& config)
{
  const Config had = Config::fromText(saved.settings, "the state's settings");
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      const std::string before = had.text(section, key).value_or("not there");
      if (!isSameSetting(section, key, value.text, before))
      {
        throw UserError(section + "." + key + " is " + value.text +
                        ", in the run to resume it is " + before +
                        "; leave out --config, --set and other options of the settings, or start "
                        "anew");
      }
    }
  }
}

RunToResume::RunToResume(const std::string& folder)
    : lock(lockedFolder(folder)), file((fs::path(folder) / run_files::state).string(), state_parts)
{
  load(StatePart::run, [this](StateArchive& archive) { archive(run); });
  if (run.version != DYSLAM_VERSION)
  {
    throw UserError((fs::path(folder) / run_files::state).string() + ": is of DySLAM " +
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
