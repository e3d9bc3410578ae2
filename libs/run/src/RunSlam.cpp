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
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

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

/** Saves the front end, in its thread, if a checkpoint is due after this frame.
 * \param is_last the run stops after it */
void beginCheckpoint(Pipeline& pipeline,
                     std::size_t frame,
                     const ScanSum& scans,
                     bool is_last,
                     CheckpointSchedule& checkpoints)
{
  if (checkpoints.due(is_last))
  {
    StateArchive archive;
    pipeline.exchangeFrontEndState(archive);
    checkpoints.begin(frame, {archive.bytes(), pipeline.summary(), scans, is_last});
  }
}

/** Passes every frame through the pipeline and to the outputs: reading, front end, back end and
 * writing in one thread each, which processes all frames in order. A checkpoint passes through the
 * threads with the frame after which it is made; no thread waits for another.
 * \param scans checksum of the scans before, for a resumed run
 * \return whether the run was stopped after a last checkpoint, at the frame that the front end was
 *   processing */
bool replay(const SlamRunSettings& settings,
            RawlogSource& source,
            SlamRun& run,
            ScanSum scans,
            const FrameCallback& on_frame)
{
  std::atomic<double> per_scan = 0;  // progress by scan; only the reading thread uses the source
  std::atomic<bool> is_stopping = false;
  bool is_stopped = false;  // set by the front end's thread; read here after the last frame
  CheckpointSchedule checkpoints(run.checkpointSeconds());
  ReadAhead reader(
      [&]
      {
        auto frame = source.next();
        if (frame)
        {
          per_scan = source.progress() / static_cast<double>(source.framesRead());
        }
        return frame;
      });
  ReadAhead front_end(
      [&]() -> std::optional<Frame>
      {
        auto frame = is_stopped ? std::nullopt : reader.next();
        if (frame)
        {
          scans.add(*frame);
          run.pipeline().runFrontEnd(*frame, reader.peek());
          is_stopped = is_stopping && reader.peek() != nullptr;
          beginCheckpoint(run.pipeline(), frame->index, scans, is_stopped, checkpoints);
        }
        return frame;
      });
  const WaitRecorder recorder(run, reader, front_end);
  while (auto frame = front_end.next())
  {
    const std::size_t index = frame->index;
    run.pipeline().runBackEnd(*frame);
    if (settings.show)
    {
      settings.show(*frame);
    }
    run.add(std::move(*frame));
    if (auto begun = checkpoints.take(index))
    {
      const auto start = std::chrono::steady_clock::now();
      run.checkpoint(*begun);
      checkpoints.recordDuration(
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    if (on_frame)
    {
      on_frame(per_scan * static_cast<double>(run.frames()), run.frames());
    }
    is_stopping = is_stopping || (settings.stop && settings.stop());
  }
  return is_stopped;
}

/** Completes a run that has been opened or resumed. */
SlamRunReport processRest(const SlamRunSettings& settings,
                          RawlogSource& source,
                          SlamRun& run,
                          const ScanSum& scans,
                          const FrameCallback& on_frame)
{
  const EarlyEnd end = replayToTheEnd(
      run, [&] { return replay(settings, source, run, scans, on_frame); },
      [&run]
      {
        if (run.frames() > 0)
        {
          run.pipeline().finish();
        }
      });
  return run.finish(source.warnings(), end);
}

/** Skips the scans that the run has processed. \throws UserError if they differ. */
ScanSum skipProcessed(const SavedRun& saved, const std::string& rawlog, RawlogSource& source)
{
  const std::string advice = "; give the recording that the run had, or start anew";
  if (std::filesystem::file_size(rawlog) != saved.rawlog_size)
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
  RawlogSource source(settings.rawlog, run.input());
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
  RawlogSource source(settings.rawlog, run.input());
  const ScanSum scans = skipProcessed(saved.run, settings.rawlog, source);
  requireNotStopped(settings);
  run.resume(saved);
  return processRest(settings, source, run, scans, on_frame);
}
}  // namespace dyslam
