// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/Backend.h>
#include <dyslam/core/Error.h>
#include <dyslam/io/RawlogSource.h>
#include <dyslam/mapping/StaticMap.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/ReadAhead.h>
#include <dyslam/pipeline/SlamRun.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <fstream>
#include <map>

#include "RunOutputs.h"

namespace dyslam
{
namespace
{
std::map<std::string, double> stageMilliseconds(const mrpt::system::CTimeLogger& times,
                                                std::size_t frames)
{
  std::map<std::string, mrpt::system::CTimeLogger::TCallStats> stats;
  times.getStats(stats);
  std::map<std::string, double> ms;
  for (const auto& [stage, stat] : stats)
  {
    ms[stage] = frames > 0 ? 1e3 * stat.total_t / static_cast<double>(frames) : 0;
  }
  return ms;
}

SlamRunReport summaryOf(const Pipeline& pipeline, const RawlogSource& source, std::size_t frames)
{
  SlamRunReport report;
  report.method = pipeline.summary();
  report.frames = frames;
  report.keyframes = pipeline.backend().keyframes().size();
  for (const auto& loop : pipeline.backend().loops())
  {
    report.loops += loop.verdict == LoopVerdict::accepted ? 1 : 0;
  }
  const auto lengths = pipeline.trajectory().pathLengths();
  report.path_length = lengths.empty() ? 0 : lengths.back();
  report.map_points = pipeline.map() == nullptr ? 0 : pipeline.map()->points().size();
  report.warnings = source.warnings();
  for (const std::string& warning : pipeline.warnings())
  {
    report.warnings.push_back(warning);
  }
  return report;
}
/** Of the scans asked for; 0 where all are. */
double shareOf(std::size_t frames, int only_first_n)
{
  return only_first_n > 0 ? static_cast<double>(frames) / only_first_n : 0;
}

/** Why scans failed, reasons that differ in their numbers counted together. */
class Reasons
{
 public:
  void add(const std::string& reason)
  {
    std::string kind = reason;
    std::replace_if(
        kind.begin(), kind.end(), [](unsigned char c) { return std::isdigit(c) != 0; }, '0');
    auto& [count, example] = kinds_[kind];
    ++count;
    example = reason;
    ++total_;
  }
  [[nodiscard]] std::size_t total() const { return total_; }
  [[nodiscard]] std::string commonest() const
  {
    const auto most = std::max_element(kinds_.begin(), kinds_.end(),
                                       [](const auto& a, const auto& b)
                                       { return a.second.first < b.second.first; });
    return most == kinds_.end() ? "" : most->second.second;
  }

 private:
  std::map<std::string, std::pair<std::size_t, std::string>> kinds_;
  std::size_t total_ = 0;
};

/** Runs that are worth a second look, though nothing failed. */
void warnOfDoubts(const Reasons& odometry_failures, SlamRunReport& report)
{
  constexpr double many = 0.2;  // of all scans
  if (static_cast<double>(odometry_failures.total()) > many * static_cast<double>(report.frames))
  {
    report.warnings.push_back(
        "odometry.method found no motion on " + std::to_string(odometry_failures.total()) + " of " +
        std::to_string(report.frames) +
        " scans, most often because: " + odometry_failures.commonest() + " (scans.csv tells each)");
  }
  const auto lost = static_cast<double>(report.unconverged);
  if (lost > many * static_cast<double>(report.frames))
  {
    report.warnings.push_back(std::to_string(report.unconverged) + " of " +
                              std::to_string(report.frames) +
                              " scans could not be registered; does the config fit the sensor? (-c "
                              "kitti64.ini is made for 64 beams, -c vlp16.ini for 16)");
  }
}
}  // namespace

SlamRunReport runSlam(const SlamRunSettings& settings,
                      const std::function<void(double, std::size_t)>& on_frame)
{
  mrpt::system::CTimeLogger times(true, "dyslam");
  times.setMinLoggingLevel(mrpt::system::LVL_ERROR);  // it would print its table at the end
  ConfigLoader config(settings.config);
  const auto input = config.get<RawlogSourceOptions>("input");
  Pipeline pipeline(config, times);
  const auto output = config.get<OutputOptions>("output");
  const auto replay = config.get<ReplayWriterOptions>("replay");
  config.requireAllUsed();

  RawlogSource source(settings.rawlog, input);
  if (!settings.profile_csv.empty() && !std::ofstream(settings.profile_csv))
  {
    throw UserError(settings.profile_csv + ": cannot be written; choose another --profile");
  }
  RunOutputs outputs(settings, output, replay, config.effective());

  std::size_t frames = 0;
  std::size_t unconverged = 0;
  Reasons odometry_failures;
  std::string damage;
  try
  {
    std::atomic<double> read = 0;  // share of the file; only the reading thread may ask the source
    ReadAhead reader(
        [&]
        {
          auto frame = source.next();
          read = source.progress();
          return frame;
        });
    while (auto frame = reader.next())
    {
      pipeline.process(*frame);
      ++frames;
      unconverged += frame->motion.converged ? 0 : 1;
      if (!frame->odometry.converged)
      {
        odometry_failures.add(frame->odometry.reason);
      }
      outputs.add(std::move(*frame), pipeline);
      if (on_frame)
      {
        on_frame(std::max(read.load(), shareOf(frames, input.only_first_n)), frames);
      }
      if (settings.stop && settings.stop())
      {
        throw UserError(settings.rawlog + ": stopped");
      }
    }
  }
  catch (const UserError& error)
  {
    if (frames == 0)
    {
      throw;
    }
    damage = error.what();  // what was read before it is worth keeping
  }

  pipeline.finish();
  outputs.finish(pipeline);
  SlamRunReport report = summaryOf(pipeline, source, frames);
  report.unconverged = unconverged;
  report.odometry_failed = odometry_failures.total();
  warnOfDoubts(odometry_failures, report);
  const auto stage_ms = stageMilliseconds(times, frames);
  for (const auto& [stage, ms] : stage_ms)
  {
    report.ms_per_scan += ms;
  }
  if (!settings.profile_csv.empty())
  {
    times.saveToCSVFile(settings.profile_csv);
  }
  outputs.writeReport(report, stage_ms);
  if (!damage.empty())
  {
    throw UserError(damage + "; results of the " + std::to_string(frames) +
                    " scans before it are in " + settings.output_folder);
  }
  return report;
}
}  // namespace dyslam
