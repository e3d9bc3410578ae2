// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/Printable.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/core/Version.h>
#include <dyslam/core/Words.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/formats/ProgramLines.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapping/ThinnedPoints.h>
#include <dyslam/pipeline/GivenBoxesOptions.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/run/SensorSettings.h>
#include <dyslam/run/SlamRun.h>
#include <dyslam/tracking/Tracker.h>
#include <mrpt/system/CTimeLogger.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "FirstPass.h"
#include "checkpoint/SavedRun.h"
#include "outputs/RunOutputs.h"
#include "results/RunHistory.h"
#include "results/RunStatistics.h"
#include "results/SmoothedTracks.h"
#include "results/TrackHindsight.h"
#include "settings/PathSettings.h"

namespace dyslam
{
namespace
{
using mrpt::system::CTimeLogger;

constexpr double history_share = 0.05;             // share of the memory limit for RunHistory
constexpr std::size_t max_shown_points = 4000000;  // map points in pictures, page and scene

/** \throws UserError unless the profile can be written and is not a file that is read. */
void requireProfileWritable(const SlamRunSettings& settings)
{
  const std::string& profile = settings.profile_csv;
  if (profile.empty())
  {
    return;
  }
  std::vector<std::string> inputs = settings.inputs;
  inputs.push_back(settings.rawlog);
  for (const std::string& input : inputs)
  {
    if (isSamePath(profile, input))
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

/** Memory by part [MB]. */
std::map<std::string, double> memoryOf(const Pipeline& pipeline)
{
  constexpr double megabyte = 1 << 20;
  const KeyframeStore& keyframes = pipeline.backend().keyframes();
  std::map<std::string, double> bytes{
      {"keyframe_clouds", static_cast<double>(keyframes.cloudMemory())},
      {"temporary_file", static_cast<double>(keyframes.memory().file->size())}};
  if (pipeline.map() != nullptr)
  {
    bytes["map"] = static_cast<double>(pipeline.map()->memory());
  }
  for (auto& [part, size] : bytes)
  {
    size /= megabyte;
  }
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  bytes["largest"] = static_cast<double>(usage.ru_maxrss) / 1024;  // kilobytes on Linux
  return bytes;
}

/** Mean time of each stage [ms]. \param frames number of frames whose times were recorded */
std::map<std::string, double> stageMilliseconds(const CTimeLogger& times, std::size_t frames)
{
  std::map<std::string, CTimeLogger::TCallStats> stats;
  times.getStats(stats);
  std::map<std::string, double> ms;
  for (const auto& [stage, stat] : stats)
  {
    ms[stage] = frames > 0 ? 1e3 * stat.total_t / static_cast<double>(frames) : 0;
  }
  return ms;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more)
{
  all.insert(all.end(), more.begin(), more.end());
}

/** Why the run ended early; empty if it did not. */
std::string reasonOf(const EarlyEnd& end, std::size_t frames)
{
  const std::string stopped =
      end.is_stopped ? stopReason("on request after " + counted(frames, "scan")) : "";
  return stopped + (stopped.empty() || end.damage.empty() ? "" : "; ") + end.damage;
}

/** Message for the user with advice. \return empty if the run did not end early */
std::string messageOf(const EarlyEnd& end, std::size_t frames, const SlamRunSettings& settings)
{
  const std::string& folder = settings.output_folder;
  std::string what;
  if (end.is_stopped)
  {
    what =
        stoppedMessage(settings.rawlog, reasonOf(end, frames)) + ", whose results are in " + folder;
    what += hasCheckpoint(folder) ? "; continue with: dyslam --resume -o " + folder : "";
  }
  else if (!end.damage.empty())
  {
    what =
        end.damage + "; results of the " + counted(frames, "scan") + " before it are in " + folder;
  }
  return what;
}

void throwWhatFailed(const std::string& early, const RunResults& results, const std::string& folder)
{
  std::string what = early;
  for (const std::string& failure : results.failures)
  {
    appendWord(what, failure, "; ");
  }
  if (!results.failures.empty())
  {
    what += "; the other results are in " + folder;
  }
  if (!what.empty())
  {
    throw UserError(what);
  }
}

/** \throws UserError for a section of dyslam-map, such as [map_export]. */
void requireNoneOfMap(const Config& config)
{
  for (const char* name : {"map_export", "merge"})
  {
    const Config::Section& section = config.section(name);
    if (!section.empty())
    {
      throw UserError(section.begin()->second.origin + ": the section [" + name +
                      "] belongs to dyslam-map");
    }
  }
}

/** Has loaded the sections that were used to choose the settings: they are part of effective.ini.
 */
ConfigLoader loaderOf(const Config& config)
{
  requireNoneOfMap(config);
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
        times(true, "dyslam"),
        config(loaderOf(settings.config)),
        track_smoothing(config.get<TrackSmoothingOptions>("track_smoothing")),
        has_boxes(!config.get<GivenBoxesOptions>("boxes").file.empty()),
        complete_boxes(config.get<TrackerOptions>("tracker").complete_boxes && !has_boxes),
        has_labels(!config.get<MovingSegmenterOptions>("dyseg").labels.empty()),
        input(config.get<RawlogSourceOptions>("input")),
        pipeline(config, times, settings.output_folder),
        history(pipeline.backend().keyframes().memory().part(history_share)),
        outputs(settings, config)
  {
    times.setMinLoggingLevel(mrpt::system::LVL_ERROR);  // otherwise it prints a table at the end
    beginEarlier(settings.first_pass_time);
    config.requireAllUsed();
    const FrameParts parts = outputs.chooseFrames(pipeline.tracksWithHindsight());
    if (pipeline.tracksWithHindsight() || parts != FrameParts::none)
    {
      pipeline.onFinal([this](Frame frame) { addFinal(std::move(frame)); }, parts);
    }
  }

  /** The settings of a run with those given, which ends before it begins. */
  [[nodiscard]] static Config effective(const Config& config);

  void addFinal(Frame frame);
  /** Adds the part of the run before it was resumed. \param seconds time of that part */
  void beginEarlier(double seconds)
  {
    begin -= std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
  }
  /** Number of scans processed since the run was resumed, whose times are known. */
  [[nodiscard]] std::size_t timedScans() const { return statistics.frames - resumed_after; }
  [[nodiscard]] std::map<std::string, double> waitMilliseconds() const;
  [[nodiscard]] RunResults results(const std::vector<std::string>& source_warnings) const;
  /** \param method Pipeline::summary() at the checkpoint, of the front end's thread */
  [[nodiscard]] RunResults resultsSoFar(const std::string& method) const;
  [[nodiscard]] SavedRun saved(const ScanSum& scans) const;
  /** \throws UserError if the settings differ from those of the state. */
  void requireSame(const SavedRun& saved) const;
  /** Objects of the graph, and others smoothed with earlier and later scans. */
  void setObjects(RunResults& results) const;
  /** But for its method, which the front end has. */
  void fillReport(SlamRunReport& report, const RunResults& results) const;

  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
  SlamRunSettings settings;
  CTimeLogger times;
  ConfigLoader config;
  TrackSmoothingOptions track_smoothing;
  bool has_boxes;  //!< boxes of another detector are used
  bool complete_boxes;
  bool has_labels;  //!< labels of an earlier run are used
  RawlogSourceOptions input;
  Pipeline pipeline;
  RunHistory history;
  RunOutputs outputs;
  RunStatistics statistics;
  std::size_t resumed_after = 0;        //!< number of scans before the run was resumed
  std::map<std::string, double> waits;  //!< waiting times of the caller's threads [s]
};

void SlamRun::Impl::addFinal(Frame frame)
{
  if (pipeline.tracksWithHindsight())
  {
    history.addObjects(frame.index, frame.objects, TrackLife::whole);
  }
  outputs.addFinal(std::move(frame));
}

std::map<std::string, double> SlamRun::Impl::waitMilliseconds() const
{
  std::map<std::string, double> seconds = waits;
  const QueueWaits writing = outputs.waits();
  seconds["back_end"] += writing.for_room;
  seconds["writing"] += writing.for_items;
  for (auto& [thread, wait] : seconds)
  {
    wait *= timedScans() > 0 ? 1e3 / static_cast<double>(timedScans()) : 0;
  }
  return seconds;
}

RunResults SlamRun::Impl::results(const std::vector<std::string>& source_warnings) const
{
  RunResults results;
  results.begin = begin;
  results.backend = &pipeline.backend();
  results.map = pipeline.map();
  results.history = &history;
  results.map_points =
      results.map == nullptr ? MapPoints() : thinnedPoints(*results.map, max_shown_points);
  results.trajectory = pipeline.trajectory();
  setObjects(results);
  results.reference = statistics.referenceInMap(results.trajectory);
  results.stage_ms = stageMilliseconds(times, timedScans());
  results.wait_ms = waitMilliseconds();
  results.memory_mb = memoryOf(pipeline);
  results.report.method = pipeline.summary();
  fillReport(results.report, results);
  append(results.report.warnings, settings.warnings);
  append(results.report.warnings, source_warnings);
  append(results.report.warnings, pipeline.warnings());
  append(results.report.warnings, statistics.warnings(has_labels));
  results.report.second_pass_advice = statistics.secondPassAdvice(has_labels);
  if (has_boxes && statistics.detections == 0)
  {
    results.report.warnings.emplace_back(
        "boxes.file has no box of a scan of this run: frames and file names are the numbers of the "
        "scans in the recording, from 0");
  }
  return results;
}

void SlamRun::Impl::setObjects(RunResults& results) const
{
  const std::vector<SmoothedObject> of_graph = pipeline.backend().smoothedObjects();
  TrackSmoothingOptions smoothing = track_smoothing;
  if (!of_graph.empty())
  {
    smoothing.merge_overlap = 1;  // in the graph every track is an object
  }
  TracksInHindsight of_tracks =
      smoothReported(history, results.trajectory, smoothing, complete_boxes);
  results.merged_tracks = std::move(of_tracks.merged);
  std::set_union(of_graph.begin(), of_graph.end(), of_tracks.objects.begin(),
                 of_tracks.objects.end(), std::back_inserter(results.objects),
                 [](const SmoothedObject& a, const SmoothedObject& b)
                 { return std::tie(a.scan, a.id) < std::tie(b.scan, b.id); });
}

void SlamRun::Impl::fillReport(SlamRunReport& report, const RunResults& results) const
{
  report.frames = statistics.frames;
  report.unconverged = statistics.registration_failures.total();
  report.failure = statistics.failure(!settings.inputs.empty());
  report.verdict = statistics.verdict();
  report.odometry_failed = statistics.odometry_failures.total();
  report.keyframes = pipeline.backend().keyframes().size();
  report.loops = pipeline.backend().factorGraph().usedLoops().size();
  report.loops_left_out = pipeline.backend().factorGraph().leftOutLoops();
  report.georeference = pipeline.backend().georeference();
  report.gravity = pipeline.backend().gravity();
  report.tracks = movingTracks(results);
  report.map_points = results.map == nullptr ? 0 : results.map->pointCount();
  const auto lengths = results.trajectory.pathLengths();
  report.path_length = lengths.empty() ? 0 : lengths.back();
  for (const auto& [stage, ms] : results.stage_ms)
  {
    report.ms_per_scan += stage.rfind("checkpoint", 0) == 0 ? 0 : ms;
  }
  report.has_reference = !results.reference.empty();
  report.recording_time = statistics.recordingTime();
  report.first_pass_time = settings.first_pass_time;
}

SlamRun::SlamRun(const SlamRunSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
SlamRun::~SlamRun() = default;

Config SlamRun::Impl::effective(const Config& config)
{
  SlamRunSettings settings;
  settings.rawlog = "none.rawlog";  // is not opened
  settings.output_folder = "none";  // is not made
  settings.config = config;
  const Impl run(settings);  // all stages and outputs load their sections, used or not
  return run.config.effective();
}

std::vector<std::string> SlamRun::sections()
{
  std::vector<std::string> names = Impl::effective({}).sectionNames();
  std::sort(names.begin(), names.end());
  return names;
}

void SlamRun::requireKnownNames(const Config& config)
{
  const Config known = Impl::effective({});
  Config unknown;
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      if (!known.has(section, key))
      {
        unknown.set(section, key, value);
      }
    }
  }
  (void)Impl::effective(unknown);  // throws what the run would
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

RunResults SlamRun::Impl::resultsSoFar(const std::string& method) const
{
  constexpr std::size_t most_voxels = 2000000;  // writing a larger map takes seconds
  RunResults results;  // without times and warnings of the front end, which is running
  results.begin = begin;
  results.backend = &pipeline.backend();
  results.map = pipeline.map();
  if (results.map != nullptr && results.map->voxelCount() > most_voxels)
  {
    results.map = nullptr;
  }
  results.history = &history;
  results.trajectory = pipeline.trajectory();
  results.reference = statistics.referenceInMap(results.trajectory);
  results.report.method = method;
  fillReport(results.report, results);
  append(results.report.warnings, settings.warnings);
  return results;
}

double SlamRun::checkpointSeconds() const
{
  return impl_->outputs.checkpointSeconds();
}

SavedRun SlamRun::Impl::saved(const ScanSum& scans) const
{
  SavedRun run;
  run.version = DYSLAM_VERSION;
  run.rawlog = std::filesystem::absolute(settings.rawlog).lexically_normal().string();
  run.rawlog_size = std::filesystem::file_size(settings.rawlog);
  run.settings = config.effective().toIni();
  run.is_second_pass = isSecondPass(config.effective(), settings.output_folder);
  std::transform(settings.inputs.begin(), settings.inputs.end(), std::back_inserter(run.inputs),
                 absolutePath);
  run.sensor = settings.sensor;
  run.warnings = settings.warnings;
  run.static_scans = settings.static_scans;
  run.labels = settings.labels;
  run.probabilities = settings.probabilities;
  run.scans = scans.scans();
  run.scans_checksum = scans.sum();
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  run.first_pass_time = settings.first_pass_time;
  return run;
}

void SlamRun::checkpoint(const BegunCheckpoint& begun)
{
  Impl& m = *impl_;
  const mrpt::system::CTimeLoggerEntry timed(m.times, "checkpoint.back_end");
  m.outputs.checkpoint(
      [&](StateFileWriter& state)
      {
        state.add(
            [&](StateArchive& archive)
            {
              SavedRun run = m.saved(begun.scans);
              archive(run);
            });
        state.add(begun.front_end);
        state.add(
            [&](StateArchive& archive)
            {
              m.pipeline.exchangeBackEndState(archive);
              archive(m.statistics, m.history);
            });
      },
      m.resultsSoFar(begun.method), begun.is_last);
}

void SlamRun::Impl::requireSame(const SavedRun& saved) const
{
  const Config now = config.effective();
  const Config had = Config::fromText(saved.settings, "the state's settings");
  for (const std::string& section : now.sectionNames())
  {
    for (const auto& [key, value] : now.section(section))
    {
      const std::string before =
          had.has(section, key) ? had.section(section).at(key).text : "not there";
      if (!isSameSetting(section, key, value.text, before))
      {
        throw UserError(section + "." + key + " is " + value.text +
                        ", in the run to resume it is " + before +
                        "; leave out --config, --set and other options of the settings, or start "
                        "anew");
      }
    }
  }
}

void SlamRun::resume(RunToResume& saved)
{
  Impl& m = *impl_;
  m.requireSame(saved.run);
  requireProfileWritable(m.settings);
  saved.load(StatePart::front_end,
             [&](StateArchive& archive) { m.pipeline.exchangeFrontEndState(archive); });
  saved.load(StatePart::back_end,
             [&](StateArchive& archive)
             {
               m.pipeline.exchangeBackEndState(archive);
               archive(m.statistics, m.history);
             });
  m.resumed_after = m.statistics.frames;
  m.beginEarlier(saved.run.seconds);
  m.settings.first_pass_time = saved.run.first_pass_time;
  m.outputs.resume(saved);
}

void SlamRun::add(Frame frame)
{
  impl_->statistics.add(frame);
  impl_->history.addScan(frame);
  if (!impl_->pipeline.tracksWithHindsight())
  {
    impl_->history.addObjects(frame.index, frame.objects, TrackLife::reported);
  }
  impl_->outputs.add(std::move(frame));
}

std::size_t SlamRun::frames() const
{
  return impl_->statistics.frames;
}

void SlamRun::noteWait(const std::string& thread, double seconds)
{
  impl_->waits[thread] += seconds;
}

double SlamRun::progress(double read) const
{
  const int limit = impl_->input.only_first_n;
  return limit > 0 ? std::max(read, static_cast<double>(frames()) / limit) : read;
}

SlamRunReport SlamRun::finish(const std::vector<std::string>& source_warnings, const EarlyEnd& end)
{
  RunResults results = impl_->results(source_warnings);
  SlamRunReport& report = results.report;
  report.ended_early = reasonOf(end, report.frames);
  if (!report.ended_early.empty())
  {
    report.warnings.insert(report.warnings.begin(),
                           "the run is not complete: " + report.ended_early);
  }
  impl_->outputs.finish(results);
  report.run_time = results.runTime();
  if (!impl_->settings.profile_csv.empty())
  {
    impl_->times.saveToCSVFile(impl_->settings.profile_csv);
  }
  throwWhatFailed(messageOf(end, report.frames, impl_->settings), results,
                  impl_->settings.output_folder);
  return report;
}
}  // namespace dyslam
