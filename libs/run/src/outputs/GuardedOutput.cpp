// SPDX-License-Identifier: BSD-3-Clause
#include "GuardedOutput.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/StateArchive.h>

#include <exception>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

namespace dyslam
{
GuardedOutput::GuardedOutput(std::unique_ptr<RunOutput> output)
    : output_(std::move(output)),
      names_(output_->names()),
      thread_(output_->thread()),
      wants_(output_->wants())
{
}

bool GuardedOutput::attempt(const std::function<void(RunOutput&)>& action)
{
  if (!output_)
  {
    return true;
  }
  try
  {
    action(*output_);
    return true;
  }
  catch (const UserError& error)
  {
    failure_ = error.what();
  }
  catch (const std::exception& error)
  {
    failure_ = names_.front().name + ": " + error.what();
  }
  output_.reset();  // its partial file may have filled the disk
  return false;
}

void GuardedOutput::open()
{
  output_->open();
}

bool GuardedOutput::add(const Frame& frame)
{
  return attempt([&](RunOutput& output) { output.add(frame); });
}

void GuardedOutput::end(const std::string& reason, const std::string& folder)
{
  failure_ = names_.front().name + ": " + reason;
  output_.reset();
  for (const OutputName& name : names_)
  {
    const std::filesystem::path path = std::filesystem::path(folder) / name.name;
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored))
    {
      std::filesystem::remove(path, ignored);
      std::filesystem::remove(path.string() + ".tmp", ignored);  // kept for a resumed run
    }
  }
}

void GuardedOutput::checkpoint(const RunResults& so_far)
{
  try
  {
    if (output_)
    {
      output_->checkpoint(so_far);
    }
  }
  catch (const std::exception&)
  {
    // finish() has the error, if it persists.
  }
}

void GuardedOutput::finish(const RunResults& results)
{
  (void)attempt([&](RunOutput& output) { output.finish(results); });
}

bool GuardedOutput::exchangeState(StateArchive& archive)
{
  bool goes_on = output_ != nullptr;
  archive(goes_on, failure_);
  is_lost_ = !goes_on;
  if (!goes_on)
  {
    output_.reset();
    return true;
  }
  StateArchive saved;
  if (!archive.isLoading())
  {
    output_->exchangeState(saved);
  }
  std::string bytes = saved.bytes();
  archive(bytes);
  return !archive.isLoading() || loadState(bytes);
}

bool GuardedOutput::loadState(const std::string& bytes)
{
  try
  {
    StateArchive archive{std::string_view(bytes)};
    output_->exchangeState(archive);
    archive.requireEnd();
    return true;
  }
  catch (const UserError& error)
  {
    if (thread_ != OutputThread::writer)
    {
      throw;
    }
    failure_ = error.what();
  }
  is_lost_ = true;
  output_.reset();
  return false;
}
}  // namespace dyslam
