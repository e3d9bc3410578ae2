// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PathSettings.h>
#include <dyslam/base/StateArchive.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/run/SensorSettings.h>
#include <dyslam/run/SlamRun.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "RunEnd.h"
#include "checkpoint/CheckpointSchedule.h"
#include "checkpoint/RunToResume.h"
#include "checkpoint/SavedRun.h"
#include "outputs/RunOutputs.h"
#include "results/ResultsBuilder.h"
#include "results/RunHistory.h"
#include "results/RunStatistics.h"
#include "results/RunTimes.h"

namespace dyslam
{
namespace
{
constexpr double history_share = 0.05;  // share of the memory limit for RunHistory

/** \throws UserError unless the profile can be written and is not a file that is read. */
void requireProfileWritable(const SlamRunSettings& settings)
{
  const std::string& profile = settings.profile_csv;
  if (profile.empty())
  {
    return;
  }
  for (const std::string& input : {settings.ini, settings.rawlog})
  {
    if (!input.empty() && isSamePath(profile, input))
    {
      throw UserError(profile + ": is an input of this run; choose another --profile");
    }
  }
  if (!std::ofstream(profile, std::ios::app))
  {
    throw UserError(profile + ": cannot be written; choose another --profile");
  }
}

/** Settings that are the same in another working directory. */
SlamRunSettings withAbsolutePaths(SlamRunSettings settings)
{
  makePathsAbsolute(settings.config);
  return settings;
}

/** Has loaded the sections that were used to choose the settings: they are part of effective.ini.
 */
ConfigLoader loaderOf(const Config& config)
{
  ConfigLoader loader(config);
  (void)loader.get<SensorOptions>("sensor");
  (void)loader.get<StartOptions>("start");
  return loader;
}
}  // namespace

struct SlamRun::Impl
{
  explicit Impl(const SlamRunSettings& given)
      : settings(withAbsolutePaths(given)),
        config(loaderOf(settings.config)),
        results(settings, config),
        input(config.get<RawlogSourceOptions>("input")),
        pipeline(config, times.stages(), settings.output_folder),
        history(pipeline.backend().keyframes().memory().part(history_share)),
        objects(pipeline.hasSecondTracking() ? FrameKind::final : FrameKind::causal),
        outputs(settings, config, objects)
  {
    times.beginEarlier(settings.first_pass_time);
    config.requireAllUsed();
    const FrameParts for_history =
        objects == FrameKind::final ? FrameParts::points : FrameParts::none;
    pipeline.onFinal([this](Frame frame) { add(FrameKind::final, std::move(frame)); },
                     std::max(for_history, outputs.finalParts()));
  }

  /** Adds a frame to statistics and history, and passes it to the outputs. \pre a final frame with
   * the objects of the results comes after the causal frame of its scan */
  void add(FrameKind kind, Frame frame);
  /** Saves StatePart::run. \param scans those processed so far */
  void saveRun(const ScanSum& scans, StateArchive& archive);
  /** Saves or loads StatePart::back_end. */
  void exchangeBackEndState(StateArchive& archive);
  [[nodiscard]] RunData data() const { return {pipeline, history, statistics, times}; }

  RunTimes times;
  SlamRunSettings settings;
  ConfigLoader config;
  ResultsBuilder results;
  RawlogSourceOptions input;
  Pipeline pipeline;
  RunHistory history;
  FrameKind objects;  //!< the frames that have the objects of the results
  RunOutputs outputs;
  RunStatistics statistics;
};

void SlamRun::Impl::add(FrameKind kind, Frame frame)
{
  if (kind == FrameKind::causal)
  {
    statistics.add(frame);
    history.addScan(frame);
  }
  if (kind == objects)
  {
    const TrackLife life = kind == FrameKind::final ? TrackLife::whole : TrackLife::reported;
    history.addObjects(frame.index, frame.objects, life);
  }
  outputs.add(kind, std::move(frame));
}

void SlamRun::Impl::saveRun(const ScanSum& scans, StateArchive& archive)
{
  SavedRun run = savedRunOf(settings, config.effective(), scans, times.seconds());
  archive(run);
}

void SlamRun::Impl::exchangeBackEndState(StateArchive& archive)
{
  pipeline.exchangeBackEndState(archive);
  archive(statistics, history);
}

SlamRun::SlamRun(const SlamRunSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
SlamRun::~SlamRun() = default;

Config SlamRun::effective() const
{
  return impl_->config.effective();
}

Pipeline& SlamRun::pipeline()
{
  return impl_->pipeline;
}

const RawlogSourceOptions& SlamRun::input() const
{
  return impl_->input;
}

void SlamRun::open()
{
  requireProfileWritable(impl_->settings);
  impl_->outputs.open();
}

double SlamRun::checkpointSeconds() const
{
  return impl_->outputs.checkpointSeconds();
}

void SlamRun::checkpoint(const BegunCheckpoint& begun)
{
  Impl& m = *impl_;
  const mrpt::system::CTimeLoggerEntry timed(m.times.stages(), "checkpoint.back_end");
  m.outputs.checkpoint(
      [&](StateFileWriter& state)
      {
        state.add([&](StateArchive& archive) { m.saveRun(begun.scans, archive); });
        state.add(begun.front_end);
        state.add([&](StateArchive& archive) { m.exchangeBackEndState(archive); });
      },
      m.results.soFar(m.data(), begun.method), begun.is_last);
}

void SlamRun::resume(RunToResume& saved)
{
  Impl& m = *impl_;
  requireSameSettings(saved.run, m.config.effective());
  requireProfileWritable(m.settings);
  saved.load(StatePart::front_end,
             [&](StateArchive& archive) { m.pipeline.exchangeFrontEndState(archive); });
  saved.load(StatePart::back_end, [&](StateArchive& archive) { m.exchangeBackEndState(archive); });
  m.times.leaveOut(m.statistics.frames);
  m.times.beginEarlier(saved.run.seconds);
  m.settings.first_pass_time = saved.run.first_pass_time;
  m.outputs.resume(saved);
}

void SlamRun::add(Frame frame)
{
  impl_->add(FrameKind::causal, std::move(frame));
}

std::size_t SlamRun::frames() const
{
  return impl_->statistics.frames;
}

void SlamRun::noteWait(const std::string& thread, double seconds)
{
  impl_->times.noteWait(thread, seconds);
}

void SlamRun::announce(const std::string& work) const
{
  if (impl_->settings.after_scans && frames() > 0)
  {
    impl_->settings.after_scans(work);
  }
}

SlamRunReport SlamRun::finish(const std::vector<std::string>& source_warnings, const EarlyEnd& end)
{
  Impl& m = *impl_;
  announce("writing the results");
  RunResults results = m.results.atEnd(m.data(), source_warnings);
  results.wait_ms = m.times.waitMilliseconds(m.statistics.frames, m.outputs.waits());
  SlamRunReport& report = results.report;
  report.ended_early = earlyEndReason(end, report.frames);
  if (!report.ended_early.empty())
  {
    report.warnings.insert(report.warnings.begin(),
                           "the run is not complete: " + report.ended_early);
  }
  m.outputs.finish(results);
  report.run_time = results.runTime();
  if (!m.settings.profile_csv.empty())
  {
    m.times.stages().saveToCSVFile(m.settings.profile_csv);
  }
  requireComplete(end, results, m.settings);
  return report;
}
}  // namespace dyslam
