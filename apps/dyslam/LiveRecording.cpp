// SPDX-License-Identifier: BSD-3-Clause
#include "LiveRecording.h"

#include <dyslam/base/Error.h>

namespace dyslam
{
LiveRecording::LiveRecording(const std::string& input,
                             const std::string& rawlog,
                             const ScanConverterOptions& options,
                             const std::function<bool()>& stop,
                             const std::function<void(const std::string&)>& print,
                             const std::function<void(const std::string&)>& vehicle_frame)
{
  LiveRecorderHooks hooks;
  hooks.stop = [this, stop] { return is_ending_ || stop(); };
  hooks.listening = [print](const std::string& name) { print("waits for " + name); };
  hooks.warn = [print](const std::string& warning) { print("warning: " + warning); };
  hooks.vehicle_frame = vehicle_frame;
  hooks.recorded = [this](std::size_t)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    recorded_.push_back(Clock::now());
    changed_.notify_all();
  };
  thread_ = std::thread([=] { record(input, rawlog, options, hooks); });
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return has_ended_ || !recorded_.empty(); });
  if (recorded_.empty())
  {
    thread_.join();  // the lock is not needed any more, nor held by the thread that has ended
    throw UserError(failure_.value_or(input + ": no scan was received"));
  }
}

LiveRecording::~LiveRecording()
{
  end();
}

void LiveRecording::record(const std::string& input,
                           const std::string& rawlog,
                           const ScanConverterOptions& options,
                           const LiveRecorderHooks& hooks)
{
  ConversionResult result;
  std::optional<std::string> failure;
  try
  {
    result = recordLive(input, rawlog, options, hooks);
  }
  catch (const std::exception& error)
  {
    failure = error.what();
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_any_processed_ && !recorded_.empty())
  {
    lag_ = std::chrono::duration<double>(Clock::now() - recorded_.front()).count();
  }
  result_ = std::move(result);
  failure_ = std::move(failure);
  has_ended_ = true;
  changed_.notify_all();
}

void LiveRecording::end()
{
  is_ending_ = true;
  if (thread_.joinable())
  {
    thread_.join();
  }
}

bool LiveRecording::goesOn() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return !has_ended_;
}

void LiveRecording::noteProcessed(std::size_t index)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!has_ended_ && index < recorded_.size())
  {
    is_any_processed_ = true;
    lag_ = std::chrono::duration<double>(Clock::now() - recorded_[index]).count();
  }
}

double LiveRecording::lag() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return lag_;
}
}  // namespace dyslam
