// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PathSettings.h>
#include <dyslam/batch/Batch.h>
#include <dyslam/batch/ChildProcess.h>
#include <dyslam/batch/MemoryBudget.h>
#include <dyslam/formats/ProgramLines.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "OneRun.h"

namespace dyslam::batch
{
namespace
{
// A run on street64 with the network takes 0.9 GB, one of 1700 m 2 GB.
constexpr std::uint64_t first_estimate = std::uint64_t{2} << 30U;
constexpr double share_of_available = 0.9;

struct Task
{
  std::size_t index = 0;
  bool alone = false;  //!< must run alone: it was killed before, perhaps for lack of memory
};

/** State shared by the threads; each thread has one run at a time. */
class Runner
{
 public:
  Runner(const BatchSettings& settings, std::vector<BatchResult>& results, const BatchWatch& watch)
      : settings_(settings),
        results_(results),
        watch_(watch),
        cores_(usableCores()),
        slots_(std::min(results.size(), slotsFor(settings.jobs))),
        budget_(settings.memory > 0
                    ? settings.memory
                    : static_cast<std::uint64_t>(share_of_available *
                                                 static_cast<double>(availableMemory())),
                first_estimate)
  {
    for (std::size_t i = 0; i < results.size(); ++i)
    {
      waiting_.push_back({i, false});
    }
  }

  void run()
  {
    std::vector<std::thread> threads;
    for (std::size_t slot = 0; slot < slots_; ++slot)
    {
      threads.emplace_back([this, slot] { work(coresOf(slot)); });
    }
    std::unique_lock<std::mutex> lock(mutex_);
    while (ended_ < results_.size() && !stopped())
    {
      changed_.wait_for(lock, std::chrono::milliseconds(200));
      if (watch_.progress)
      {
        watch_.progress(share(), ended_);
      }
    }
    lock.unlock();
    changed_.notify_all();
    for (std::thread& thread : threads)
    {
      thread.join();
    }
    if (refused_)
    {
      throw UserError(refusal_ + " (the same for every recording: nothing more was run)");
    }
  }

 private:
  [[nodiscard]] bool stopped() const { return refused_ || (watch_.stop && watch_.stop()); }

  /** The error message of a run that failed because of what all runs have in common: their
   * settings, or a program that cannot be run; nothing for other results. */
  [[nodiscard]] std::optional<std::string> refusalOf(const Manifest& m) const
  {
    if (m.state != State::failed)
    {
      return std::nullopt;
    }
    if (m.reason.rfind(settings_.program + ": ", 0) == 0)  // of runChild() or the loader
    {
      return m.reason;
    }
    const auto message = messageOfErrorLine(program_name, m.reason);
    return message && (isAboutSettings(*message, settings_.config) || isAboutNamedFile(*message))
               ? message
               : std::nullopt;
  }

  /** Number of runs at a time. \param jobs requested number; 0: number of cores */
  [[nodiscard]] std::size_t slotsFor(int jobs) const
  {
    if (jobs > 0)
    {
      return static_cast<std::size_t>(jobs);
    }
    return cores_.empty() ? std::max(1U, std::thread::hardware_concurrency()) : cores_.size();
  }

  /** Cores of a slot: an equal part of all cores; with more slots than cores, each slot has all
   * cores. */
  [[nodiscard]] std::vector<int> coresOf(std::size_t slot) const
  {
    const std::size_t each = cores_.size() / slots_;
    if (each == 0)
    {
      return cores_;
    }
    const auto begin = cores_.begin() + static_cast<std::ptrdiff_t>(slot * each);
    return {begin, slot + 1 == slots_ ? cores_.end() : begin + static_cast<std::ptrdiff_t>(each)};
  }

  /** Share of the work that is done. It never falls, also if a run begins anew. */
  [[nodiscard]] double share()
  {
    double done = 0;
    double all = 1;
    for (const BatchResult& r : results_)
    {
      const auto bytes = static_cast<double>(r.recording.bytes);
      all += bytes;
      const bool runs = r.manifest.state == State::running;
      done += bytes * (runs ? shareOfRun(workFolder(settings_, r.recording) + "/log.txt",
                                         r.recording.path, settings_.arguments)
                            : (r.manifest.state == State::unknown ? 0 : 1));
    }
    share_ = std::max(share_, std::min(done / all, 0.99));
    return share_;
  }

  /** Waits for the next task. \returns false when there is none left. */
  bool next(Task& task)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;)
    {
      if (stopped() || ended_ == results_.size())
      {
        return false;
      }
      if (waiting_.empty() && !failed_.empty() && running_ == 0)
      {
        waiting_.swap(failed_);
      }
      if (!waiting_.empty() && budget_.fits(waiting_.front().alone))
      {
        task = waiting_.front();
        waiting_.pop_front();
        budget_.start(task.alone);
        ++running_;
        return true;
      }
      changed_.wait_for(lock, std::chrono::milliseconds(200));
    }
  }

  void work(const std::vector<int>& cores)
  {
    for (Task task; next(task);)
    {
      BatchResult result;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        result = results_[task.index];
      }
      const RunEnd end = attempt(result, cores, task.index);
      const std::lock_guard<std::mutex> lock(mutex_);
      --running_;
      budget_.finish(result.skipped ? 0 : result.manifest.peak_memory);
      results_[task.index] = result;
      if (const auto refusal = refusalOf(result.manifest))
      {
        refusal_ = *refusal;
        refused_ = true;
      }
      const State state = result.manifest.state;
      if (state == State::failed && end != RunEnd::stopped &&
          result.manifest.attempts < settings_.attempts)
      {
        failed_.push_back({task.index, end == RunEnd::killed});
      }
      else if (state != State::running)
      {
        ++ended_;
        if (watch_.ended)
        {
          watch_.ended(result, ended_);
        }
      }
      changed_.notify_all();
    }
  }

  RunEnd attempt(BatchResult& result, const std::vector<int>& cores, std::size_t index)
  {
    const std::string folder = folderOf(settings_, result.recording);
    try
    {
      if (result.manifest.attempts == 0)
      {
        const auto known = readManifest(folder);
        const Work work =
            workOn(result.recording.path, commonWorkFor(settings_, result.recording), known);
        if (isDone(folder, work, known))
        {
          result.manifest = *known;
          result.skipped = true;
          return RunEnd::by_itself;
        }
        result.manifest.work = work;
      }
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        results_[index].manifest.state = State::running;
      }
      return runOne(
          settings_, cores, [this] { return stopped(); }, result);
    }
    catch (const std::exception& error)
    {
      result.manifest.attempts = settings_.attempts;
      result.manifest.state = State::failed;
      result.manifest.reason = error.what();
      recordFailure(folder, result.manifest);
      return RunEnd::by_itself;
    }
  }

  const BatchSettings& settings_;
  std::vector<BatchResult>& results_;
  const BatchWatch& watch_;
  std::vector<int> cores_;
  std::size_t slots_;

  std::mutex mutex_;
  std::condition_variable changed_;
  MemoryBudget budget_;
  std::deque<Task> waiting_;
  std::deque<Task> failed_;  //!< tasks to be run again when all others have ended
  std::size_t running_ = 0;
  std::size_t ended_ = 0;
  double share_ = 0;     //!< of the work that is done, as last told
  std::string refusal_;  //!< message of the first run that refused the common settings
  std::atomic<bool> refused_ = false;
};

/** \throws UserError if a recording is in a folder that its run would write to, such as the
 * `recording.rawlog` of an earlier run of this batch. */
void requireApartFromResults(const BatchSettings& settings, const Recording& recording)
{
  for (const std::string& folder : {folderOf(settings, recording), workFolder(settings, recording)})
  {
    if (isWithin(recording.path, folder))
    {
      throw UserError(recording.path + ": is in the folder of its results, " + folder +
                      "; choose another " +
                      (folder == folderOf(settings, recording) ? "--output" : "--scratch"));
    }
  }
}
}  // namespace

std::string folderOf(const BatchSettings& settings, const Recording& recording)
{
  return (std::filesystem::path(settings.output) / recording.name).string();
}

std::vector<BatchResult> runBatch(const BatchSettings& settings,
                                  const std::vector<Recording>& recordings,
                                  const BatchWatch& watch)
{
  std::vector<BatchResult> results;
  for (const Recording& recording : recordings)
  {
    requireApartFromResults(settings, recording);
    results.push_back({recording, {}, false});
  }
  makeFolder(settings.output, "choose another --output");
  Runner(settings, results, watch).run();
  return results;
}

std::vector<BatchResult> readBatch(const BatchSettings& settings,
                                   const std::vector<Recording>& recordings)
{
  std::vector<BatchResult> results;
  for (const Recording& recording : recordings)
  {
    const auto known = readManifest(folderOf(settings, recording));
    results.push_back({recording, known.value_or(Manifest()), false});
  }
  return results;
}
}  // namespace dyslam::batch
