// SPDX-License-Identifier: BSD-3-Clause
#include "ResultsBuilder.h"

#include <dyslam/backend/Backend.h>
#include <dyslam/dyseg/MovingSegmenter.h>
#include <dyslam/mapping/ThinnedPoints.h>
#include <dyslam/pipeline/GivenBoxesOptions.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/tracking/Tracker.h>
#include <sys/resource.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

#include "ReportedObjects.h"
#include "SmoothedTracks.h"

namespace dyslam
{
namespace
{
constexpr std::size_t max_shown_points = 4000000;  // map points in pictures, page and scene

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

/** A run that was to be localised in a prior map, and was not, has failed. */
void requireLocalised(SlamRunReport& report)
{
  if (report.prior_map && !report.prior_map->localised && report.failure.empty())
  {
    const std::string& reason = report.prior_map->reason;
    report.failure = "the run was not localised in the prior map: " +
                     (reason.empty() ? "it has no keyframe with points" : reason) +
                     "; the results are in a map frame of the run's own";
    report.verdict = "doubtful";
  }
}

/** What the results refer to, and the trajectories: at any time between two frames. */
RunResults beginResults(const RunData& run)
{
  RunResults results;
  results.begin = run.times.begin();
  results.backend = &run.pipeline.backend();
  results.map = run.pipeline.map();
  results.history = &run.history;
  results.trajectory = run.pipeline.trajectory();
  results.reference = run.statistics.referenceInMap(results.trajectory);
  return results;
}

void append(std::vector<std::string>& all, const std::vector<std::string>& more)
{
  all.insert(all.end(), more.begin(), more.end());
}
}  // namespace

ResultsBuilder::ResultsBuilder(const SlamRunSettings& settings, ConfigLoader& config)
    : settings_(settings),
      motion_sensors_(config.get<MotionSensorOptions>("motion_sensors")),
      track_smoothing_(config.get<TrackSmoothingOptions>("track_smoothing")),
      has_boxes_(!config.get<GivenBoxesOptions>("boxes").file.empty()),
      complete_boxes_(config.get<TrackerOptions>("tracker").complete_boxes && !has_boxes_),
      has_labels_(!config.get<MovingSegmenterOptions>("dyseg").labels.empty())
{
}

RunResults ResultsBuilder::atEnd(const RunData& run,
                                 const std::vector<std::string>& source_warnings) const
{
  RunResults results = beginResults(run);
  results.map_points =
      results.map == nullptr ? MapPoints() : thinnedPoints(*results.map, max_shown_points);
  setObjects(run, results);
  results.stage_ms = run.times.stageMilliseconds(run.statistics.frames);
  results.memory_mb = memoryOf(run.pipeline);
  results.report.method = run.pipeline.summary();
  fillReport(run, results);
  requireLocalised(results.report);
  append(results.report.warnings, settings_.warnings);
  append(results.report.warnings, source_warnings);
  append(results.report.warnings, run.pipeline.warnings());
  append(results.report.warnings, run.statistics.warnings(has_labels_));
  results.report.second_pass_advice = run.statistics.secondPassAdvice(has_labels_);
  if (has_boxes_ && run.statistics.detections == 0)
  {
    results.report.warnings.emplace_back(
        "boxes.file has no box of a scan of this run: frames and file names are the numbers of the "
        "scans in the recording, from 0");
  }
  return results;
}

RunResults ResultsBuilder::soFar(const RunData& run, const std::string& method) const
{
  constexpr std::size_t most_voxels = 2000000;  // writing a larger map takes seconds
  RunResults results = beginResults(run);
  if (results.map != nullptr && results.map->voxelCount() > most_voxels)
  {
    results.map = nullptr;
  }
  // Without times and warnings of the front end, which is running.
  results.report.method = method;
  fillReport(run, results);
  append(results.report.warnings, settings_.warnings);
  return results;
}

void ResultsBuilder::setObjects(const RunData& run, RunResults& results) const
{
  const std::vector<SmoothedObject> of_graph = run.pipeline.backend().smoothedObjects();
  TrackSmoothingOptions smoothing = track_smoothing_;
  if (!of_graph.empty())
  {
    smoothing.merge_overlap = 1;  // in the graph every track is an object
  }
  SmoothedTracks of_tracks =
      smoothTracks(run.history, results.trajectory, smoothing, complete_boxes_);
  results.merged_tracks = std::move(of_tracks.merged);
  std::set_union(of_graph.begin(), of_graph.end(), of_tracks.objects.begin(),
                 of_tracks.objects.end(), std::back_inserter(results.objects),
                 [](const SmoothedObject& a, const SmoothedObject& b)
                 { return std::tie(a.scan, a.id) < std::tie(b.scan, b.id); });
}

void ResultsBuilder::fillReport(const RunData& run, RunResults& results) const
{
  SlamRunReport& report = results.report;
  report.frames = run.statistics.frames;
  report.unconverged = run.statistics.registration_failures.total();
  report.failure = run.statistics.failure(settings_.ini, motion_sensors_);
  report.verdict = run.statistics.verdict();
  report.odometry_failed = run.statistics.odometry_failures.total();
  report.keyframes = run.pipeline.backend().keyframes().size();
  report.loops = run.pipeline.backend().factorGraph().usedLoops().size();
  report.loops_left_out = run.pipeline.backend().factorGraph().leftOutLoops().size();
  report.georeference = run.pipeline.backend().georeference();
  report.gravity = run.pipeline.backend().gravity();
  report.prior_map = run.pipeline.backend().priorMapFit();
  const TrackCounts tracks = countTracks(results);
  report.tracks = tracks.moving;
  report.reported_tracks = tracks.reported;
  report.map_points = results.map == nullptr ? 0 : results.map->pointCount();
  const auto lengths = results.trajectory.pathLengths();
  report.path_length = lengths.empty() ? 0 : lengths.back();
  for (const auto& [stage, ms] : results.stage_ms)
  {
    report.ms_per_scan += stage.rfind("checkpoint", 0) == 0 ? 0 : ms;
  }
  report.has_reference = !results.reference.empty();
  report.recording_time = run.statistics.recordingTime();
  report.first_pass_time = settings_.first_pass_time;
}
}  // namespace dyslam
