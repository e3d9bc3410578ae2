// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/FreedMemory.h>
#include <dyslam/core/SharedFiles.h>
#include <dyslam/pipeline/SlamRun.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"

namespace
{
struct Arguments
{
  dyslam::SlamRunSettings settings;
  std::string config = "kitti64.ini";
  std::vector<std::string> assignments;
  std::string verbosity = "INFO";
  std::optional<int> skip_first_n;
  std::optional<int> only_first_n;
};

void declare(CLI::App& app, Arguments& a)
{
  app.description("Replays a rawlog of 3D LiDAR scans: trajectory, moving objects, static map");
  app.add_option("-i,--input", a.settings.rawlog, "rawlog to replay")->required();
  app.add_option("-c,--config", a.config, "ini file, or the name of a shipped one")
      ->capture_default_str();
  app.add_option("-o,--output", a.settings.output_folder, "folder for the results")->required();
  app.add_option("--set", a.assignments, "section.key=value, as if it stood in the ini; repeatable")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--labels", a.settings.labels,
               "write labels/NNNNNN.label, moving and static points");
  app.add_flag("--static-scans", a.settings.static_scans,
               "write the scans without moving points: static_scans/NNNNNN.bin and a rawlog");
  app.add_option("--skip-first-n", a.skip_first_n, "scans to pass over")
      ->check(dyslam::notNegative());
  app.add_option("--only-first-n", a.only_first_n, "scans to process after those; 0: all")
      ->check(dyslam::notNegative());
  app.add_option("--profile", a.settings.profile_csv, "CSV file for the times of every stage");
  app.add_option("-v,--verbosity", a.verbosity, "what is printed")
      ->check(CLI::IsMember({"ERROR", "INFO"}))
      ->capture_default_str();
}

// The only thing a signal can reach.
std::atomic<bool> stop_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may set it");

/** Ctrl-C and kill end the run after the scan at hand; the second time they kill as usual. */
void stopOnSignals()
{
  struct sigaction action = {};
  action.sa_handler = [](int) { stop_asked = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void print(const dyslam::SlamRunReport& report, const std::string& folder)
{
  for (const auto& warning : report.warnings)
  {
    std::printf("warning: %s\n", warning.c_str());
  }
  std::printf("%s\n", report.method.c_str());
  std::printf("%zu scans, %.1f m, %zu keyframes, %zu loops, %zu moving objects, %zu map points\n",
              report.frames, report.path_length, report.keyframes, report.loops, report.tracks,
              report.map_points);
  if (report.unconverged > 0)
  {
    std::printf("%zu scans could not be registered; their motion is predicted\n",
                report.unconverged);
  }
  std::printf("%.1f ms per scan\n", report.ms_per_scan);
  std::printf("results in %s:", folder.c_str());
  for (const auto& file : report.files)
  {
    std::printf(" %s", file.c_str());
  }
  std::printf("\n");
  if (report.has_reference)
  {
    std::printf("errors against the ground truth: dyslam-eval run %s\n", folder.c_str());
  }
}
}  // namespace

int main(int argc, char** argv)
{
  dyslam::keepFreedMemory();
  Arguments a;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, a); },
      [&]
      {
        dyslam::requireConverted(a.settings.rawlog);
        auto& config = a.settings.config;
        config =
            dyslam::Config::fromFile(dyslam::findGivenOrShared(a.config, "config_files", ".ini"));
        for (const auto& assignment : a.assignments)
        {
          config.set(assignment);
        }
        if (a.skip_first_n)
        {
          config.set("input.skip_first_n=" + std::to_string(*a.skip_first_n));
        }
        if (a.only_first_n)
        {
          config.set("input.only_first_n=" + std::to_string(*a.only_first_n));
        }
        stopOnSignals();
        a.settings.stop = [] { return stop_asked.load(); };
        const bool quiet = a.verbosity == "ERROR";
        dyslam::SlamRunReport report;
        {
          dyslam::Progress progress("dyslam", "scans", quiet);
          report = dyslam::runSlam(a.settings, [&](double fraction, std::size_t frames)
                                   { progress.update(fraction, frames); });
          progress.finish(report.frames);
        }
        if (!quiet)
        {
          print(report, a.settings.output_folder);
        }
        if (!report.failure.empty())
        {
          throw dyslam::UselessResult(report.failure);
        }
      });
}
