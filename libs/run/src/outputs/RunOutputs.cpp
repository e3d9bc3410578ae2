// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutputs.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <future>
#include <string_view>
#include <utility>

#include "../folder/OutputFolder.h"
#include "RunOutputOptions.h"

namespace fs = std::filesystem;

namespace dyslam
{
namespace
{
/** Files named in a config, such as weights and detections. */
std::vector<std::string> filesNamedIn(const Config& config)
{
  std::vector<std::string> files;
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      std::error_code ignored;
      if (fs::exists(value.text, ignored))
      {
        files.push_back(value.text);
      }
    }
  }
  return files;
}

/** Calls `action` with the output; an output that throws is disabled. \return false if it did */
template <typename Entry, typename Action>
bool attempt(Entry& entry, const Action& action)
{
  if (!entry.output)
  {
    return true;
  }
  try
  {
    action(*entry.output);
    return true;
  }
  catch (const UserError& error)
  {
    entry.failure = error.what();
  }
  catch (const std::exception& error)
  {
    entry.failure = entry.names.front().name + ": " + error.what();
  }
  entry.output.reset();  // its partial file may have filled the disk
  return false;
}
}  // namespace

RunOutputs::RunOutputs(const SlamRunSettings& settings,
                       ConfigLoader& config,
                       const std::vector<RunOutputKind>& kinds)
    : folder_(settings.output_folder),
      force_(settings.force),
      config_(config),
      kept_files_(folder_),
      warn_(settings.warn),
      checkpoints_(folder_, settings.warn)
{
  if (!settings.ini.empty())
  {
    inputs_.push_back(settings.ini);
  }
  inputs_.push_back(settings.rawlog);
  const auto options = config.get<RunOutputOptions>("output");
  checkpoint_seconds_ = options.checkpoint_seconds;
  names_.emplace_back(run_files::state);
  for (const RunOutputKind& kind : kinds)
  {
    Entry entry;
    entry.output = kind.make({settings, config, options.scene_voxel_size});
    entry.names = entry.output->names();
    entry.slow = entry.output->isSlow();
    entry.final_parts = entry.output->wants();
    names_.insert(names_.end(), entry.names.begin(), entry.names.end());
    if (kind.changes_files)
    {
      names_.push_back(kept_files_.add(entry.names.front()));
    }
    const bool asked = kind.flag == nullptr || settings.*kind.flag;
    if (asked && (kind.key == nullptr || options.on.at(kind.key)))
    {
      entries_.push_back(std::move(entry));
    }
  }
}

void RunOutputs::open()
{
  std::vector<std::string> inputs = inputs_;
  const Config effective = config_.effective();
  const std::vector<std::string> named = filesNamedIn(effective);
  inputs.insert(inputs.end(), named.begin(), named.end());
  if (const auto labels = labelFolderOf(effective.text("dyseg", "labels").value_or("")))
  {
    inputs.push_back(*labels);
  }
  made_ = std::make_unique<OutputFolder>(folder_, names_, inputs, force_);
  for (const Entry& entry : entries_)
  {
    entry.output->open();
  }
  writer_ = std::make_unique<JobThread>();
}

void RunOutputs::exchangeState(StateArchive& archive, bool slow)
{
  for (Entry& entry : entries_)
  {
    if (entry.slow != slow)
    {
      continue;
    }
    bool goes_on = entry.output != nullptr;
    archive(goes_on, entry.failure);
    entry.is_lost = !goes_on;
    if (!goes_on)
    {
      entry.output.reset();
      continue;
    }
    StateArchive saved;
    if (!archive.isLoading())
    {
      entry.output->exchangeState(saved);
    }
    std::string bytes = saved.bytes();
    archive(bytes);
    if (archive.isLoading())
    {
      loadState(bytes, entry);
    }
  }
}

void RunOutputs::loadState(const std::string& bytes, Entry& entry) const
{
  try
  {
    StateArchive archive{std::string_view(bytes)};
    entry.output->exchangeState(archive);
    archive.requireEnd();
  }
  catch (const UserError& error)
  {
    if (!entry.slow)
    {
      throw;
    }
    entry.failure = error.what();
    entry.is_lost = true;
    entry.output.reset();
    warnOfLost(entry);
  }
}

void RunOutputs::warnOfLost(const Entry& entry) const
{
  if (warn_)
  {
    warn_(entry.failure + "; the run goes on without it");
  }
}

void RunOutputs::checkpoint(const std::function<void(StateFileWriter&)>& add_state,
                            const RunResults& results,
                            bool is_last)
{
  if (is_last)
  {
    waitForWriter();
  }
  if (checkpoints_.isWriting())
  {
    return;
  }
  RunResults so_far = results;
  for (Entry& entry : entries_)
  {
    try
    {
      if (!entry.slow && entry.output)
      {
        entry.output->checkpoint(so_far);
      }
    }
    catch (const std::exception&)
    {
      // finish() reports the error, if it persists.
    }
    listFiles(entry, so_far.report);
  }
  checkpoints_.write(
      [&](StateFileWriter& state)
      {
        add_state(state);
        state.add([this](StateArchive& archive) { exchangeState(archive, false); });
      },
      [this](StateFileWriter& state)
      { state.add([this](StateArchive& archive) { exchangeState(archive, true); }); },
      *writer_);
  if (is_last)
  {
    is_stopped_ = true;
    writer_->add([this] { keepFiles(); });
  }
}

void RunOutputs::waitForWriter()
{
  auto done = std::make_shared<std::promise<void>>();
  const std::future<void> reached = done->get_future();
  writer_->add([promise = std::move(done)] { promise->set_value(); });
  reached.wait();
}

void RunOutputs::keepFiles()
{
  try
  {
    kept_files_.keep();
    are_files_kept_ = true;
  }
  catch (const std::exception& error)
  {
    checkpoints_.setUnusable(error.what());
  }
}

void RunOutputs::resume(RunToResume& run)
{
  made_ = std::move(run.lock);
  checkpoints_.setResumable();
  run.load(StatePart::outputs, [this](StateArchive& archive) { exchangeState(archive, false); });
  run.load(StatePart::slow_outputs,
           [this](StateArchive& archive) { exchangeState(archive, true); });
  kept_files_.restore();
  writer_ = std::make_unique<JobThread>();
}

void RunOutputs::add(Frame frame)
{
  add(std::move(frame), false);
}

FrameParts RunOutputs::chooseFrames(bool tracks_again)
{
  FrameParts parts = FrameParts::none;
  for (const Entry& entry : entries_)
  {
    parts = std::max(parts, entry.final_parts);
  }
  if (tracks_again)
  {
    return parts;
  }
  const bool is_any_cloud_final = parts > FrameParts::intensity;
  for (Entry& entry : entries_)
  {
    if (entry.final_parts == FrameParts::points ||
        (entry.final_parts == FrameParts::intensity && !is_any_cloud_final))
    {
      entry.final_parts = FrameParts::none;
    }
  }
  return is_any_cloud_final ? parts : FrameParts::none;
}

void RunOutputs::addFinal(Frame frame)
{
  add(std::move(frame), true);
}

void RunOutputs::add(Frame frame, bool is_final)
{
  addTo(frame, false, is_final);
  if (std::any_of(entries_.begin(), entries_.end(),
                  [&](const Entry& entry) { return entry.slow && entry.getsFinal() == is_final; }))
  {
    writer_->add([this, is_final, shared = std::make_shared<const Frame>(std::move(frame))]
                 { addTo(*shared, true, is_final); });
  }
}

void RunOutputs::addTo(const Frame& frame, bool slow, bool is_final)
{
  for (Entry& entry : entries_)
  {
    if (entry.slow == slow && entry.getsFinal() == is_final)
    {
      if (!attempt(entry, [&](RunOutput& output) { output.add(frame); }))
      {
        warnOfLost(entry);
      }
    }
  }
}

void RunOutputs::finish(RunResults& results)
{
  if (!fs::is_directory(folder_))
  {
    results.failures.push_back(folder_ + ": was removed during the run, with what was in it");
    std::error_code ignored;
    fs::create_directories(folder_, ignored);  // for the files written now
  }
  if (checkpoints_.isWriting())
  {
    writer_->finish();  // the result of its checkpoint is in the report
  }
  if (const std::string warning = checkpoints_.warning(); !warning.empty())
  {
    results.report.warnings.push_back(warning);
  }
  for (Entry& entry : entries_)
  {
    if (entry.slow)
    {
      writer_->finish();
    }
    (void)attempt(entry, [&](RunOutput& output) { output.finish(results); });
    if (!entry.failure.empty())
    {
      results.failures.push_back(entry.failure);
    }
    listFiles(entry, results.report);
  }
  writer_->finish();  // a checkpoint may still be written
  removeState(results.report.ended_early.empty());
}

void RunOutputs::removeState(bool at_end)
{
  const bool can_be_completed =
      at_end &&
      std::any_of(entries_.begin(), entries_.end(),
                  [](const Entry& entry) { return !entry.failure.empty() && !entry.is_lost; });
  const bool is_stopped = is_stopped_ && are_files_kept_;
  if ((is_stopped || can_be_completed) && checkpoints_.isResumable())
  {
    kept_files_.removeUnchanged();
    return;
  }
  std::error_code ignored;
  fs::remove(fs::path(folder_) / run_files::state, ignored);
  kept_files_.removeAll();
}

void RunOutputs::listFiles(const Entry& entry, SlamRunReport& report) const
{
  for (const OutputName& name : entry.names)
  {
    if (fs::exists(fs::path(folder_) / name.name))
    {
      report.files.push_back(name.name);
    }
  }
}
}  // namespace dyslam
