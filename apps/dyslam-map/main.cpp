// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/io/Conversion.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"
#include "../common/StopSignals.h"
#include "Arguments.h"
#include "Settings.h"

namespace
{
/** Shows progress and warnings on stderr, and ends the work on request. */
class Printer : public dyslam::MapListener
{
 public:
  explicit Printer(bool quiet) : quiet_(quiet) {}

  void beginReading(const std::string& purpose) override
  {
    progress_.emplace(purpose.empty() ? "dyslam-map" : "dyslam-map (" + purpose + ")", "scans",
                      quiet_);
  }
  void beginWriting(const std::string& names, const std::string& unit) override
  {
    progress_.emplace(names, unit, quiet_);
  }
  void update(double fraction, std::size_t count) override
  {
    if (dyslam::stop_asked)
    {
      throw dyslam::MapStopped("stopped on request; files that were not complete are removed");
    }
    progress_->update(fraction, count);
  }
  void finish(std::size_t count) override
  {
    progress_->finish(count);
    progress_.reset();
  }
  void warn(const std::string& text) override
  {
    progress_.reset();
    std::fprintf(stderr, "warning: %s\n", dyslam::printable(text).c_str());
  }

 private:
  bool quiet_;
  std::optional<dyslam::Progress> progress_;
};

/** " of 0.20 m"; empty for points that are not one per voxel. */
std::string voxelText(const dyslam::MapReport& report, bool full_resolution)
{
  return full_resolution || report.voxel_size == 0
             ? ""
             : dyslam::formatted(" of %.2f m", report.voxel_size);
}

void printCounts(const dyslam::MapReport& report, bool full_resolution)
{
  std::printf("%s, %zu without a pose, %s%s, %s%s\n", dyslam::counted(report.scans, "scan").c_str(),
              report.skipped,
              report.unregistered == 0
                  ? ""
                  : (std::to_string(report.unregistered) + " not registered by the run, ").c_str(),
              dyslam::counted(report.keyframes, "keyframe").c_str(),
              dyslam::counted(report.points, "map point").c_str(),
              voxelText(report, full_resolution).c_str());
}

/** \throws UserError */
void requireComplete(const dyslam::MapReport& report)
{
  if (!report.problem.empty())
  {
    throw dyslam::UserError(report.problem);
  }
}

void runSingle(dyslam::Arguments& a)
{
  if (!a.inputs.run.empty())
  {
    dyslam::completeFromRun(a.inputs.run, a.inputs.recording);
  }
  dyslam::requireConverted(a.inputs.recording.rawlog);
  dyslam::checkOutputs(a);
  dyslam::loadConfig(a);
  Printer printer(a.quiet);
  const dyslam::MapReport report =
      dyslam::buildMap(a.inputs.recording, a.builder, a.outputs, printer);
  requireComplete(report);
  printCounts(report, a.outputs.exports.full_resolution);
}

void runMerged(dyslam::Arguments& a)
{
  const auto runs = dyslam::readRunFolders(a.inputs.runs, a.inputs.recording.scans.tolerance);
  dyslam::checkOutputs(a);
  dyslam::loadConfig(a);
  Printer printer(a.quiet);
  const dyslam::MergeReport report =
      dyslam::mergeMaps(runs, a.merger, a.builder, a.outputs, printer);
  std::printf("%s%s%zu of %zu runs joined, ", report.table.c_str(), report.references.c_str(),
              report.joined, runs.size());
  printCounts(report, a.outputs.exports.full_resolution);
  requireComplete(report);
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { dyslam::declare(app, a); },
      [&]
      {
        dyslam::stopOnSignals();
        if (!a.map_pose.empty())
        {
          a.outputs.T_fixed_map = dyslam::poseFromOption("--map-pose", a.map_pose);
        }
        a.inputs.runs.empty() ? runSingle(a) : runMerged(a);
      });
}
