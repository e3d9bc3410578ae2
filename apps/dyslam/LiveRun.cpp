// SPDX-License-Identifier: BSD-3-Clause
#include "LiveRun.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/core/Frame.h>
#include <dyslam/run/FolderLock.h>
#include <dyslam/run/RunSlam.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "../common/Checks.h"
#include "../common/ConversionReport.h"
#include "../common/Progress.h"
#include "../common/SlamProgram.h"
#include "../common/StopSignals.h"
#include "ConvertedFiles.h"
#include "InputConversion.h"
#include "LiveRecording.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
using VehicleFrameHook = std::function<void(const std::string&)>;

constexpr const char* recorder_program = "scans2rawlog";  //!< makes the same recording

/** \throws UserError for what can be wrong before the lidar is needed. */
void requireReady(SlamArguments& a, const RecordingOptions& options, const ConvertedFiles& files)
{
  if (a.resume)
  {
    throw UserError(a.settings.rawlog + ": --resume reads the rawlog of the run, " + files.rawlog +
                    "; leave out --input");
  }
  requireNoUnfinishedRun(a.settings);
  completeSettings(a, options);
}

/** Warning about a run that could not keep up; empty if it could. */
std::string warningOfLag(double lag)
{
  constexpr double usual = 2;  // the run looks ahead by a few scans [s]
  return lag < usual
             ? ""
             : formatted(
                   "the run was %.1f s behind the lidar when the recording ended; -c fast.ini is "
                   "faster, or record with scans2rawlog and run later",
                   lag);
}

/** A recording that goes on, and what a run tells and asks of it. */
class LiveInput
{
 public:
  /** Begins the recording. \throws UserError if there is no first scan. */
  LiveInput(const SlamArguments& a,
            const RecordingOptions& options,
            const ConvertedFiles& files,
            const VehicleFrameHook& vehicle_frame)
      : input_(a.settings.rawlog), quiet_(a.quiet()), files_(files)
  {
    ScanConverterOptions of_recording;
    static_cast<RecordingOptions&>(of_recording) = options;
    recording_ = std::make_unique<LiveRecording>(
        input_, files.rawlog, of_recording,
        [] { return recording_end_asked.load() || stop_asked.load(); },
        [quiet = quiet_](const std::string& line)
        {
          if (!quiet)
          {
            printAbove("dyslam: " + line);
          }
        },
        vehicle_frame);
    files_.writeOrigin(input_, recorder_program, {});
  }

  /** Lets a run on the rawlog tell what it has processed, and end the recording. */
  void attachTo(SlamArguments& a)
  {
    a.settings.rawlog = files_.rawlog;
    a.settings.show = [this, show = a.settings.show](const Frame& frame)
    {
      recording_->noteProcessed(frame.index);
      if (show)
      {
        show(frame);
      }
    };
    a.settings.end_of_scans = [this] { return end(); };
    a.lag = [this] { return lag(); };
  }

  /** Prints what was recorded. \throws UserError if an error has ended the recording. */
  void report()
  {
    (void)end();
    if (recording_->failure())
    {
      throw UserError(*recording_->failure());
    }
    if (!quiet_)
    {
      ConversionResult result = recording_->result();
      result.warnings.clear();  // the run has printed them
      dyslam::report(result, files_.rawlog);
    }
  }

 private:
  /** Ends the recording. \return its warnings, once */
  std::vector<std::string> end()
  {
    recording_->end();
    RecordingSignal::recordingEnded();
    if (std::exchange(has_ended_, true))
    {
      return {};
    }
    std::vector<std::string> warnings = recording_->result().warnings;
    if (const auto& failure = recording_->failure())
    {
      warnings.push_back("the recording ended with an error: " + *failure);
    }
    files_.writeOrigin(input_, recorder_program, warnings);
    if (const std::string lag = warningOfLag(recording_->lag()); !lag.empty())
    {
      warnings.push_back(lag);
    }
    return warnings;
  }

  /** For the line of progress; called after each scan. */
  std::string lag()
  {
    if (recording_->goesOn())
    {
      return formatted("%.1f s behind", recording_->lag());
    }
    if (!std::exchange(end_is_told_, true))
    {
      RecordingSignal::recordingEnded();
      if (!quiet_)
      {
        printAbove(
            "dyslam: the recording has ended; the rest of its scans is processed (Ctrl-C ends the "
            "run)");
      }
    }
    return "";
  }

  std::string input_;
  bool quiet_;
  ConvertedFiles files_;
  std::unique_ptr<LiveRecording> recording_;
  bool has_ended_ = false;
  bool end_is_told_ = false;
};

/** Makes the output folder, locked while it is not a run's yet, and begins the recording there.
 * \throws UserError, and leaves no new folder then. */
std::unique_ptr<LiveInput> beginRecording(const SlamArguments& a,
                                          const RecordingOptions& options,
                                          const ConvertedFiles& files,
                                          const VehicleFrameHook& vehicle_frame)
{
  const bool is_new_folder = !fs::exists(files.folder);
  makeFolder(files.folder, "choose another --output");
  try
  {
    const FolderLock lock(files.folder);
    requireNewRecording(files.rawlog, a.settings.force || files.canBeMadeAgain());
    return std::make_unique<LiveInput>(a, options, files, vehicle_frame);
  }
  catch (...)
  {
    std::error_code ignored;
    if (is_new_folder)
    {
      fs::remove(files.folder, ignored);  // only if it is empty
    }
    throw;
  }
}
}  // namespace

void runLive(SlamArguments& a,
             const RecordingOptions& options,
             const VehicleFrameHook& vehicle_frame)
{
  const ConvertedFiles files(a.settings.output_folder);
  requireReady(a, options, files);
  const RecordingSignal signal;
  stopOnSignals();
  const auto input = beginRecording(a, options, files, vehicle_frame);
  input->attachTo(a);
  runSlamProgram("dyslam", a, runSlam);
  input->report();
}
}  // namespace dyslam
