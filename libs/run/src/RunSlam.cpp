// SPDX-License-Identifier: BSD-3-Clause
// A recording from its first scan to the last file: the threads of a run, and resumed runs.
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/FrontEnd.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/ReadAhead.h>
#include <dyslam/run/RunSlam.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "checkpoint/CheckpointSchedule.h"
#include "checkpoint/RunToResume.h"
#include "checkpoint/ScanSum.h"

namespace dyslam
{
namespace
{
/** Passes the waiting times of the threads to the run when it ends, also by an exception. */
class WaitRecorder
{
 public:
  WaitRecorder(SlamRun& run, ReadAhead& reader, ReadAhead& front_end)
      : run_(run), reader_(reader), front_end_(front_end)
  {
  }
  ~WaitRecorder()
  {
    const QueueWaits scans = reader_.waits();
    const QueueWaits frames = front_end_.waits();
    run_.noteWait("reading", scans.for_room);
    const FrontEndWaits encoding = run_.pipeline().frontEndWaits();
    run_.noteWait("front_end", scans.for_items + frames.for_room + encoding.for_encoding);
    if (encoding.for_scans > 0)
    {
      run_.noteWait("encoding", encoding.for_scans);
    }
    run_.noteWait("back_end", frames.for_items);
  }
  WaitRecorder(const WaitRecorder&) = delete;
  WaitRecorder& operator=(const WaitRecorder&) = delete;

 private:
  SlamRun& run_;
  ReadAhead& reader_;
  ReadAhead& front_end_;
};

/** Passes every frame through the pipeline and to the outputs. Reading, front end, back end and
 * writing have one thread each, which processes all frames in order. A checkpoint passes through
 * the threads with the frame after which it is made; no thread waits for another. */
class RunThreads
{
 public:
  /** Reading and front end begin at once. \param scans checksum of the scans before, for a resumed
   * run \param settings, source, run, on_frame outlive the object */
  RunThreads(const SlamRunSettings& settings,
             RawlogSource& source,
             SlamRun& run,
             const ScanSum& scans,
             const FrameCallback& on_frame)
      : settings_(settings),
        source_(source),
        run_(run),
        on_frame_(on_frame),
        scans_(scans),
        checkpoints_(run.checkpointSeconds())
  {
  }

  /** Runs back end and outputs on all frames, in the calling thread. \return whether the run was
   * stopped after a last checkpoint: at the frame that the front end was processing, or while it
   * waited for more of a rawlog that grows */
  bool processAll()
  {
    while (auto frame = front_end_.next())
    {
      const std::size_t index = frame->index;
      run_.pipeline().runBackEnd(*frame);
      if (settings_.show)
      {
        settings_.show(*frame);
      }
      run_.add(std::move(*frame));
      completeCheckpoint(index);
      if (on_frame_)
      {
        on_frame_(per_scan_ * static_cast<double>(run_.frames()), run_.frames());
      }
      is_stopping_ = is_stopping_ || (settings_.stop && settings_.stop());
    }
    return is_stopped_;
  }

 private:
  /** In the reading thread: the next frame; nothing at the end. */
  std::optional<Frame> read()
  {
    auto frame = source_.next();
    if (frame)
    {
      per_scan_ = source_.progress() / static_cast<double>(source_.framesRead());
    }
    return frame;
  }

  /** In the front end's thread: the next frame with its pose; nothing at the end of the recording,
   * or after the last frame of a run that is stopped. */
  std::optional<Frame> runFrontEnd()
  {
    auto frame = is_stopped_ ? std::nullopt : reader_.next();
    if (frame)
    {
      scans_.add(*frame);
      run_.pipeline().runFrontEnd(*frame, reader_.peek());
      // What the source says may be read once its thread has ended, with nothing ahead.
      is_stopped_ = reader_.peek() != nullptr ? is_stopping_.load() : source_.isStopped();
      beginCheckpoint(frame->index);
    }
    return frame;
  }

  /** In the front end's thread, after a frame: saves the front end if a checkpoint is due. */
  void beginCheckpoint(std::size_t frame)
  {
    if (checkpoints_.due(is_stopped_))
    {
      Pipeline& pipeline = run_.pipeline();
      StateArchive archive;
      pipeline.exchangeFrontEndState(archive);
      checkpoints_.begin(frame, {archive.bytes(), pipeline.summary(), scans_, is_stopped_});
    }
  }

  /** In the calling thread, after a frame: writes the checkpoint that was begun after it, if any.
   */
  void completeCheckpoint(std::size_t frame)
  {
    if (auto begun = checkpoints_.take(frame))
    {
      const auto start = std::chrono::steady_clock::now();
      run_.checkpoint(*begun);
      checkpoints_.recordDuration(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
  }

  const SlamRunSettings& settings_;
  RawlogSource& source_;  //!< only the reading thread uses it, while it runs
  SlamRun& run_;
  const FrameCallback& on_frame_;
  ScanSum scans_;  //!< only the front end's thread uses it
  CheckpointSchedule checkpoints_;
  std::atomic<double> per_scan_ = 0;       //!< progress by scan
  std::atomic<bool> is_stopping_ = false;  //!< to be stopped
  bool is_stopped_ = false;  //!< set by the front end's thread; read by processAll() after its end
  // Last, as their threads use the others; each ends before those that it uses.
  ReadAhead reader_{[this] { return read(); }};
  ReadAhead front_end_{[this] { return runFrontEnd(); }};
  WaitRecorder recorder_{run_, reader_, front_end_};
};

/** Completes a run that has been opened or resumed. */
SlamRunReport processRest(const SlamRunSettings& settings,
                          RawlogSource& source,
                          SlamRun& run,
                          const ScanSum& scans,
                          const FrameCallback& on_frame)
{
  if (settings.levelled)
  {
    settings.levelled(run.input().levelling());
  }
  std::vector<std::string> late_warnings;
  const EarlyEnd end = replayToTheEnd(
      run, [&] { return RunThreads(settings, source, run, scans, on_frame).processAll(); },
      [&]
      {
        if (settings.end_of_scans)
        {
          late_warnings = settings.end_of_scans();
        }
        if (run.frames() > 0)
        {
          run.pipeline().finish();
        }
      });
  std::vector<std::string> warnings = source.warnings();
  warnings.insert(warnings.end(), late_warnings.begin(), late_warnings.end());
  return run.finish(warnings, end);
}

/** Skips the scans that the run has processed. \throws UserError if they differ. */
ScanSum skipProcessed(const SavedRun& saved, const std::string& rawlog, RawlogSource& source)
{
  const std::string advice = "; give the recording that the run had, or start anew";
  const std::uintmax_t size = std::filesystem::file_size(rawlog);
  if (size < saved.rawlog_size || (size > saved.rawlog_size && !saved.rawlog_grew))
  {
    throw UserError(rawlog + ": has another size than when the run began" + advice);
  }
  ScanSum scans;
  while (scans.scans() < saved.scans)
  {
    const auto frame = source.next();
    if (!frame)
    {
      break;
    }
    scans.add(*frame);
  }
  if (scans.scans() != saved.scans || scans.sum() != saved.scans_checksum)
  {
    throw UserError(rawlog + ": differs from the recording of the run in its first " +
                    counted(saved.scans, "scan") + advice);
  }
  return scans;
}
}  // namespace

void requireNotStopped(const SlamRunSettings& settings, const std::string& when)
{
  if (settings.stop && settings.stop())
  {
    throw UserError(stoppedMessage(settings.rawlog, stopReason(when)));
  }
}

EarlyEnd replayToTheEnd(const SlamRun& run,
                        const std::function<bool()>& replay,
                        const std::function<void()>& finish)
{
  EarlyEnd end;
  std::exception_ptr failure;
  try
  {
    end.is_stopped = replay();
  }
  catch (const std::exception& error)
  {
    failure = std::current_exception();
    end.damage = error.what();
  }
  try
  {
    run.announce("completing graph, labels and map");
    finish();
  }
  catch (const std::exception& error)
  {
    appendWord(end.damage, error.what(), "; ");
  }
  if (failure && run.frames() == 0)
  {
    std::rethrow_exception(failure);
  }
  return end;
}

SlamRunReport runSlam(const SlamRunSettings& settings, const FrameCallback& on_frame)
{
  SlamRun run(settings);
  RawlogSource source(settings.rawlog, run.input(), settings.stop);
  requireNotStopped(settings);
  run.open();
  return processRest(settings, source, run, ScanSum(), on_frame);
}

bool hasCheckpoint(const std::string& output_folder)
{
  return std::filesystem::exists(std::filesystem::path(output_folder) / run_files::state);
}

Config settingsOfCheckpoint(const std::string& output_folder)
{
  return Config::fromText(RunToResume(output_folder).run.settings, "the state's settings");
}

SlamRunReport resumeSlam(const SlamRunSettings& given, const FrameCallback& on_frame)
{
  RunToResume saved(given.output_folder);
  const SlamRunSettings settings = settingsOf(saved.run, given);
  SlamRun run(settings);
  RawlogSource source(settings.rawlog, run.input(), settings.stop);
  const ScanSum scans = skipProcessed(saved.run, settings.rawlog, source);
  requireNotStopped(settings);
  run.resume(saved);
  return processRest(settings, source, run, scans, on_frame);
}
}  // namespace dyslam
