// SPDX-License-Identifier: BSD-3-Clause
#include "Arguments.h"

#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/RuntimeModule.h>
#include <dyslam/base/SharedFiles.h>
#include <dyslam/base/Version.h>
#include <dyslam/base/Words.h>
#include <dyslam/formats/RecordingKind.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <system_error>
#include <utility>

#include "../common/Checks.h"
#include "../common/ConversionFlags.h"
#include "../common/OutputOptions.h"
#include "../common/RangeFlags.h"

namespace dyslam::batch
{
namespace
{
/** Checksums of the files that values of settings name, such as weights and boxes. */
std::string checksumsOfFilesIn(const Config& config)
{
  std::string sums;
  for (const std::string& section : config.sectionNames())
  {
    for (const auto& [key, value] : config.section(section))
    {
      std::error_code none;
      if (std::filesystem::is_regular_file(value.text, none))
      {
        sums += checksumOfFile(value.text);
      }
    }
  }
  return sums;
}
}  // namespace

void declare(CLI::App& app, Arguments& a)
{
  app.description(
      "Runs dyslam on many recordings, here or as jobs of Slurm; resumes where it stopped");
  app.add_option(
         "recordings", a.entries,
         "rawlogs, ROS bags, captures (.pcap), KITTI drives and folders of scans, folders of "
         "them, patterns, and lists (.txt) of all these")
      ->required();
  addOutputFolder(app, "-o,--output", a.output,
                  "folder for the results, one within for each recording")
      ->required();
  app.add_option("-c,--config", a.config, "as of dyslam: ini file, or the name of a shipped one");
  app.add_option("--set", a.assignments, "as of dyslam; repeatable")
      ->type_name("SECTION.KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  app.add_flag("--labels", a.labels, "as of dyslam: write moving and static points");
  app.add_flag("--probabilities", a.probabilities,
               "as of dyslam: write the moving probability of each point");
  app.add_flag("--static-scans", a.static_scans, "as of dyslam: write scans without moving points");
  for (CLI::Option* flag : declareScanCount(app, a.range, "process"))
  {
    flag->description("as of dyslam, of each recording");
  }
  app.add_option("--passes", a.passes, "as of dyslam: 2 to process each recording twice")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  app.add_option("--jobs", a.jobs, "recordings at once; 0: as many as cores (0)")
      ->check(CLI::Range(0, 4096));
  app.add_option("--memory", a.memory,
                 "of all runs together [GiB]; 0: 90 % of the available memory (0)")
      ->check(CLI::Range(0.0, 1e9));
  addOutputFolder(app, "--scratch", a.scratch,
                  "folder to run in, on a disk of this machine, with --slurm of each node; whole "
                  "results move to --output");
  app.add_option("--shard", a.shard, "K/N: only the K-th of every N recordings of the list");
  CLI::Option* no_summary =
      app.add_flag("--no-summary", a.no_summary, "write no table and page at the end");
  app.add_flag("--gather", a.gather,
               "run nothing, only write table and page of the existing results")
      ->excludes(no_summary);
  CLI::Option* slurm = app.add_flag(
      "--slurm", a.slurm,
      "submit an array of Slurm jobs, and one after it that gathers the results; --output must be "
      "on storage that all nodes share");
  for (const char* of_this_machine : {"--jobs", "--memory", "--no-summary", "--gather"})
  {
    slurm->excludes(app.get_option(of_this_machine));
  }
  app.add_option("--slurm-options", a.slurm_options,
                 "of sbatch, as \"--partition=x --mem=8G --cpus-per-task=4\"")
      ->needs(slurm);
  app.add_flag("-q,--quiet", a.quiet, "no progress");
  declareConversion(app, a.conversion);
}

std::vector<std::string> runArguments(const Arguments& a)
{
  std::vector<std::string> words;
  if (!a.config.empty())
  {
    words.insert(words.end(), {"-c", a.config});
  }
  for (const std::string& assignment : a.assignments)
  {
    words.insert(words.end(), {"--set", assignment});
  }
  const auto add = [&words](bool given, const std::vector<std::string>& more)
  { words.insert(words.end(), more.begin(), given ? more.end() : more.begin()); };
  add(a.labels, {"--labels"});
  add(a.probabilities, {"--probabilities"});
  add(a.static_scans, {"--static-scans"});
  add(a.range.skip_first_n > 0, {"--skip-first-n", std::to_string(a.range.skip_first_n)});
  add(a.range.only_first_n > 0, {"--only-first-n", std::to_string(a.range.only_first_n)});
  add(a.passes > 1, {"--passes", std::to_string(a.passes)});
  return words;
}

void requireFittingConversion(const RecordingOptions& conversion,
                              const std::vector<Recording>& recordings)
{
  const std::string flag = conversion.givenFlag();
  if (flag.empty())
  {
    return;
  }
  bool is_used = false;
  for (const Recording& recording : recordings)
  {
    const RecordingKind kind = recordingKind(recording.path);
    if (kind == RecordingKind::unknown)
    {
      continue;
    }
    is_used = true;
    try
    {
      conversion.requireFitting(kind);
    }
    catch (const UserError& error)
    {
      throw UserError(recording.path + ": " + error.what());
    }
  }
  if (!is_used)
  {
    throw UserError(flag + ": is for recordings that are converted, and none of these is; " +
                    "leave it out");
  }
}

Work commonWork(const Arguments& a, const std::string& program)
{
  Work work;
  work.version = DYSLAM_VERSION;
  std::string sums = checksumOfFile(program);
  for (const auto& [folder, extension] :
       {std::pair("config_files", ".ini"), std::pair("models", ".safetensors")})
  {
    for (const std::string& file : sharedFiles(folder, extension))
    {
      sums += checksumOfFile(file);
    }
  }
  if (const std::string networks = runtimeModuleFile("networks"); !networks.empty())
  {
    sums += checksumOfFile(networks);  // of this machine: results differ in their last digits
  }
  for (const std::string& file : a.conversion.files())
  {
    sums += checksumOfFile(file);
  }
  Arguments flags = a;
  Config config;
  if (!a.config.empty())
  {
    config = Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam"));
    config.requireFor("dyslam");
    flags.config = config.toIni();
  }
  for (const std::string& assignment : a.assignments)
  {
    config.set(assignment);
  }
  work.program_checksum = checksumOfText(sums + checksumsOfFilesIn(config));
  work.settings = joined(runArguments(flags), " ");
  return work;
}
}  // namespace dyslam::batch
