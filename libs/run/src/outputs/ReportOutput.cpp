// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/PendingFile.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/RunReport.h>

#include <filesystem>
#include <string>

#include "RunOutput.h"

namespace dyslam
{
namespace
{
/** `report.json`: figures of the run. It is written last, marks the end of a run, and names files
 * that could not be written. */
class ReportOutput : public RunOutput
{
 public:
  explicit ReportOutput(const RunOutputContext& context)
      : RunOutput(context, {run_files::report}),
        input_(std::filesystem::absolute(context.settings.rawlog).lexically_normal().string()),
        sensor_(context.settings.sensor),
        truth_(poseOrigin(groundTruthFolder(context.settings.rawlog)))
  {
  }
  void checkpoint(const RunResults& results) override { write(results, false); }
  void finish(const RunResults& results) override
  {
    write(results, results.report.ended_early.empty());
  }

 private:
  void write(const RunResults& results, bool finished) const
  {
    writeWhole(path(run_files::report), runReportText(reportOf(results, finished)));
  }

  [[nodiscard]] RunReport reportOf(const RunResults& results, bool finished) const
  {
    SlamRunReport of_run = results.report;
    of_run.run_time = results.runTime();
    RunReport report;
    report.input = input_;
    report.sensor = sensor_;
    if (of_run.has_reference)
    {
      report.ground_truth = truth_;
    }
    report.method = of_run.method;
    report.finished = finished;
    report.ended_early = of_run.ended_early;
    report.frames = of_run.frames;
    report.unconverged = of_run.unconverged;
    report.odometry_failed = of_run.odometry_failed;
    report.keyframes = of_run.keyframes;
    report.loops = of_run.loops;
    report.loops_left_out = of_run.loops_left_out;
    if (const auto& found = of_run.georeference)
    {
      report.gnss = {found->fixes, found->horizontal_rmse, found->vertical_rmse, found->fused};
    }
    report.gravity = of_run.gravity;
    report.prior_map = of_run.prior_map;
    report.tracks = of_run.tracks;
    report.map_points = of_run.map_points;
    report.path_length = of_run.path_length;
    report.ms_per_scan = of_run.ms_per_scan;
    report.stage_ms = results.stage_ms;
    report.wait_ms = results.wait_ms;
    report.memory_mb = results.memory_mb;
    report.recording_time = of_run.recording_time;
    report.run_time = of_run.run_time;
    report.realtime_factor = of_run.realtimeFactor();
    report.verdict = of_run.verdict;
    report.failure = of_run.failure;
    report.warnings = of_run.warnings;
    report.not_written = results.failures;
    report.files = of_run.files;
    report.files.emplace_back(run_files::report);
    return report;
  }

  std::string input_;
  std::string sensor_;
  PoseOrigin truth_;
};
}  // namespace

std::unique_ptr<RunOutput> makeReportOutput(const RunOutputContext& context)
{
  return std::make_unique<ReportOutput>(context);
}
}  // namespace dyslam
