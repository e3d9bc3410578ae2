// SPDX-License-Identifier: BSD-3-Clause
#include "CheckpointWriter.h"

#include <dyslam/formats/RunFiles.h>
#include <fcntl.h>
#include <unistd.h>

#include <exception>
#include <filesystem>
#include <utility>

namespace dyslam
{
namespace
{
/** Waits until all that was written in the folder is on the disk. */
void synchronise(const std::string& folder)
{
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file >= 0)
  {
    ::syncfs(file);
    ::close(file);
  }
}
}  // namespace

CheckpointWriter::CheckpointWriter(std::string folder, std::function<void(const std::string&)> warn)
    : folder_(std::move(folder)), warn_(std::move(warn))
{
}

void CheckpointWriter::write(const AddParts& add_first, AddParts add_last, JobThread& thread)
{
  try
  {
    auto state = std::make_shared<StateFileWriter>(
        (std::filesystem::path(folder_) / run_files::state).string());
    state_ = state;
    add_first(*state);
    thread.add([this, state, add = std::move(add_last)] { finish(*state, add); });
  }
  catch (const std::exception& error)
  {
    note(error.what());
  }
}

void CheckpointWriter::finish(StateFileWriter& state, const AddParts& add_last)
{
  try
  {
    add_last(state);
    synchronise(folder_);
    state.commit();
    note("");
  }
  catch (const std::exception& error)
  {
    note(error.what());
  }
}

void CheckpointWriter::note(const std::string& failure)
{
  bool warn = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    failure_ = failure;
    is_resumable_ = is_resumable_ || failure.empty();
    warn = !failure.empty() && !has_warned_ && warn_;
    has_warned_ = has_warned_ || warn;
  }
  if (warn)
  {
    warn_(warning());
  }
}

void CheckpointWriter::setResumable()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  is_resumable_ = true;
}

void CheckpointWriter::setUnusable(const std::string& reason)
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_resumable_ = false;
  }
  note(reason);
}

bool CheckpointWriter::isResumable() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_resumable_;
}

std::string CheckpointWriter::warning() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_.empty())
  {
    return "";
  }
  return "checkpoints could not be written: " + failure_ +
         (is_resumable_ ? "; the run can be resumed from an earlier one only"
                        : "; the run cannot be resumed");
}
}  // namespace dyslam
