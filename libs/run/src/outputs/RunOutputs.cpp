// SPDX-License-Identifier: BSD-3-Clause
#include "RunOutputs.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/PathSettings.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/RunFiles.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <future>
#include <utility>

#include "../folder/OutputFolder.h"
#include "RunOutputOptions.h"

namespace fs = std::filesystem;

namespace dyslam
{
RunOutputs::RunOutputs(const SlamRunSettings& settings,
                       ConfigLoader& config,
                       FrameKind objects,
                       const std::vector<RunOutputKind>& kinds,
                       FreeSpace free_space)
    : folder_(settings.output_folder),
      force_(settings.force),
      config_(config),
      kept_files_(folder_),
      free_space_(std::move(free_space)),
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
  std::vector<WantedFrames> wanted;
  for (const RunOutputKind& kind : kinds)
  {
    GuardedOutput output(kind.make({settings, config, options.scene_voxel_size}));
    names_.insert(names_.end(), output.names().begin(), output.names().end());
    if (kind.changes_files)
    {
      names_.push_back(kept_files_.add(output.names().front()));
    }
    const bool asked = kind.flag == nullptr || settings.*kind.flag;
    if (asked && (kind.key == nullptr || options.on.at(kind.key)))
    {
      wanted.push_back(output.wants());
      outputs_.push_back(std::move(output));
    }
  }
  routing_ = FrameRouting(wanted, objects);
}

std::vector<std::string> RunOutputs::inputFiles() const
{
  std::vector<std::string> inputs = inputs_;
  const Config effective = config_.effective();
  const std::vector<std::string> named = filesNamedIn(effective);
  inputs.insert(inputs.end(), named.begin(), named.end());
  if (const auto labels = labelFolderOf(effective.text("dyseg", "labels").value_or("")))
  {
    inputs.push_back(*labels);
  }
  return inputs;
}

void RunOutputs::open()
{
  made_ = std::make_unique<OutputFolder>(folder_, names_, inputFiles(), force_);
  for (GuardedOutput& output : outputs_)
  {
    output.open();
  }
  writer_ = std::make_unique<JobThread>();
}

void RunOutputs::exchangeState(OutputThread thread, StateArchive& archive)
{
  for (GuardedOutput& output : outputs_)
  {
    if (output.thread() == thread && !output.exchangeState(archive))
    {
      warnOfLost(output);
    }
  }
}

void RunOutputs::warnOfLost(const GuardedOutput& output) const
{
  if (warn_)
  {
    warn_(output.failure() + "; the run goes on without it");
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
  writeSoFar(results);
  checkpoints_.write(
      [&](StateFileWriter& state)
      {
        add_state(state);
        state.add([this](StateArchive& archive) { exchangeState(OutputThread::caller, archive); });
      },
      [this](StateFileWriter& state) {
        state.add([this](StateArchive& archive) { exchangeState(OutputThread::writer, archive); });
      },
      *writer_);
  if (is_last)
  {
    is_stopped_ = true;
    writer_->add([this] { keepFiles(); });
  }
}

void RunOutputs::writeSoFar(RunResults results)
{
  for (GuardedOutput& output : outputs_)
  {
    if (output.thread() == OutputThread::caller)
    {
      output.checkpoint(results);
    }
    listFiles(output, results.report);
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
  run.load(StatePart::caller_outputs,
           [this](StateArchive& archive) { exchangeState(OutputThread::caller, archive); });
  run.load(StatePart::writer_outputs,
           [this](StateArchive& archive) { exchangeState(OutputThread::writer, archive); });
  kept_files_.restore();
  writer_ = std::make_unique<JobThread>();
}

bool RunOutputs::receives(const GuardedOutput& output, OutputThread thread, FrameKind kind) const
{
  return output.thread() == thread && routing_.kindFor(output.wants()) == kind;
}

void RunOutputs::add(FrameKind kind, Frame frame)
{
  pass(OutputThread::caller, kind, frame);
  if (std::any_of(outputs_.begin(), outputs_.end(),
                  [&](const GuardedOutput& output)
                  { return receives(output, OutputThread::writer, kind); }))
  {
    writer_->add(
        [this, kind, shared = std::make_shared<const Frame>(std::move(frame))]
        {
          keepDiskReserve(shared->index + 1);
          pass(OutputThread::writer, kind, *shared);
        });
  }
}

void RunOutputs::keepDiskReserve(std::size_t scans)
{
  for (auto output = outputs_.rbegin(); output != outputs_.rend(); ++output)
  {
    const std::uintmax_t free = free_space_(folder_);
    if (free >= diskReserve(scans))
    {
      return;
    }
    if (output->thread() == OutputThread::writer && !output->hasEnded())
    {
      output->end(formatted("ends after %s: the disk has %.0f MB free, which are left for "
                            "trajectory and map; free some space or choose another --output",
                            counted(scans - 1, "scan").c_str(), static_cast<double>(free) / 1e6),
                  folder_);
      warnOfLost(*output);
    }
  }
}

void RunOutputs::pass(OutputThread thread, FrameKind kind, const Frame& frame)
{
  for (GuardedOutput& output : outputs_)
  {
    if (receives(output, thread, kind) && !output.add(frame))
    {
      warnOfLost(output);
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
  for (GuardedOutput& output : outputs_)
  {
    if (output.thread() == OutputThread::writer)
    {
      writer_->finish();
    }
    output.finish(results);
    if (!output.failure().empty())
    {
      results.failures.push_back(output.failure());
    }
    listFiles(output, results.report);
  }
  writer_->finish();  // a checkpoint may still be written
  removeState(results.report.ended_early.empty());
}

void RunOutputs::removeState(bool at_end)
{
  const bool can_be_completed = at_end && std::any_of(outputs_.begin(), outputs_.end(),
                                                      [](const GuardedOutput& output)
                                                      { return output.hasFailedSinceState(); });
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

void RunOutputs::listFiles(const GuardedOutput& output, SlamRunReport& report) const
{
  for (const OutputName& name : output.names())
  {
    if (fs::exists(fs::path(folder_) / name.name))
    {
      report.files.push_back(name.name);
    }
  }
}
}  // namespace dyslam
