// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/batch/Batch.h>
#include <dyslam/batch/SlurmJob.h>
#include <dyslam/batch/Summary.h>
#include <dyslam/core/Config.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/RuntimeModule.h>
#include <dyslam/core/Shard.h>
#include <dyslam/core/SharedFiles.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/Progress.h"
#include "../common/StopSignals.h"

namespace
{
namespace fs = std::filesystem;
using namespace dyslam;
using namespace dyslam::batch;

struct Arguments
{
  std::vector<std::string> entries;
  std::string output, config, scratch, shard, slurm_options;
  std::vector<std::string> assignments;
  bool labels = false, probabilities = false, static_scans = false;
  int skip_first_n = 0, only_first_n = 0;
  int passes = 1;
  int jobs = 0;
  double memory = 0;
  bool quiet = false, no_summary = false, gather = false, slurm = false;
};

void declare(CLI::App& app, Arguments& a)
{
  app.description(
      "Runs dyslam on many recordings, here or as jobs of Slurm; resumes where it stopped");
  app.add_option("recordings", a.entries,
                 "rawlogs, folders of them, patterns, and lists (.txt) of all these")
      ->required();
  app.add_option("-o,--output", a.output, "folder for the results, one within for each recording")
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
  app.add_option("--skip-first-n", a.skip_first_n, "as of dyslam, of each recording")
      ->check(notNegative());
  app.add_option("--only-first-n", a.only_first_n, "as of dyslam, of each recording")
      ->check(notNegative());
  app.add_option("--passes", a.passes, "as of dyslam: 2 to process each recording twice")
      ->check(CLI::IsMember({1, 2}))
      ->capture_default_str();
  app.add_option("--jobs", a.jobs, "recordings at once; 0: as many as cores (0)")
      ->check(CLI::Range(0, 4096));
  app.add_option("--memory", a.memory,
                 "of all runs together [GiB]; 0: 90 % of the available memory (0)")
      ->check(notNegative());
  app.add_option("--scratch", a.scratch,
                 "folder to run in, on a disk of this machine, with --slurm of each node; whole "
                 "results move to --output");
  app.add_option("--shard", a.shard, "K/N: only the K-th of every N recordings of the list");
  app.add_flag("--no-summary", a.no_summary, "write no table and page at the end");
  app.add_flag("--gather", a.gather,
               "run nothing, only write table and page of the existing results");
  CLI::Option* slurm = app.add_flag(
      "--slurm", a.slurm,
      "submit an array of Slurm jobs, and one after it that gathers the results; --output must be "
      "on storage that all nodes share");
  for (const char* of_this_machine : {"--jobs", "--memory", "--no-summary", "--gather"})
  {
    slurm->excludes(app.get_option(of_this_machine));
  }
  app.add_option("--slurm-options", a.slurm_options,
                 "of sbatch, as \"--partition=x --mem=8G --cpus-per-task=4\"");
  app.add_flag("-q,--quiet", a.quiet, "no progress");
}

/** Arguments of dyslam that change results. */
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
  add(a.skip_first_n > 0, {"--skip-first-n", std::to_string(a.skip_first_n)});
  add(a.only_first_n > 0, {"--only-first-n", std::to_string(a.only_first_n)});
  add(a.passes > 1, {"--passes", std::to_string(a.passes)});
  return words;
}

/** A program of the folder of this one. */
std::string programBeside(const std::string& name)
{
  const fs::path self = fs::read_symlink("/proc/self/exe");
  const std::string path = (self.parent_path() / name).string();
  if (::access(path.c_str(), X_OK) != 0)
  {
    throw UserError(path + ": is not there; install dyslam-batch beside it");
  }
  return path;
}

/** What all runs have in common, with the ini's values instead of its name. \throws UserError. */
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
  work.program_checksum = checksumOfText(sums);
  Arguments flags = a;
  if (!a.config.empty())
  {
    Config config =
        Config::fromFile(findGivenOrShared(a.config, "config_files", ".ini", "", "dyslam"));
    config.requireFor("dyslam");
    flags.config = config.toIni();
  }
  for (const std::string& assignment : a.assignments)
  {
    Config().set(assignment);
  }
  for (const std::string& word : runArguments(flags))
  {
    work.settings += (work.settings.empty() ? "" : " ") + word;
  }
  return work;
}

void say(const BatchResult& r, std::size_t ended, std::size_t all)
{
  const Manifest& m = r.manifest;
  std::ostringstream line;
  line << ended << "/" << all << " " << r.recording.name << ": " << toString(m.state);
  if (r.skipped)
  {
    line << " before";
  }
  else
  {
    char figures[64];
    std::snprintf(figures, sizeof figures, ", %.1f s, %.2f GiB", m.seconds,
                  static_cast<double>(m.peak_memory) / (1U << 30U));
    line << figures << (m.attempts > 1 ? ", run twice" : "");
  }
  line << (m.reason.empty() ? "" : ": " + printable(m.reason));
  std::cout << (isatty(1) == 1 ? "\r\033[K" : "") << line.str() << std::endl;
}

/** \throws UserError if the batch was stopped. */
std::vector<BatchResult> runHere(const Arguments& a,
                                 const BatchSettings& settings,
                                 const std::vector<Recording>& recordings)
{
  stopOnSignals(SecondSignal::ignored);
  std::signal(SIGCHLD, SIG_DFL);  // ignored, as a parent may leave it, it would hide how runs end
  Progress progress("dyslam-batch", "recordings", a.quiet);
  BatchWatch watch;
  watch.stop = [] { return stop_asked.load(); };
  watch.progress = [&progress](double share, std::size_t ended) { progress.update(share, ended); };
  watch.ended = [&a, &recordings](const BatchResult& result, std::size_t ended)
  {
    if (!a.quiet)
    {
      say(result, ended, recordings.size());
    }
  };
  const auto results = runBatch(settings, recordings, watch);
  const Counts counts = countsOf(results);
  if (counts.open > 0)
  {
    throw UserError("stopped: " + toText(counts) + "; the same command goes on");
  }
  progress.finish(results.size());
  return results;
}

/** \throws UserError. */
void submitToSlurm(const Arguments& a, const std::vector<Recording>& recordings)
{
  SlurmJob job;
  job.program = fs::read_symlink("/proc/self/exe").string();
  job.output = fs::absolute(a.output).lexically_normal().string();
  job.list = job.output + "/slurm/recordings.txt";
  job.scratch = a.scratch.empty() ? "" : fs::absolute(a.scratch).lexically_normal().string();
  Arguments absolute = a;
  if (fs::is_regular_file(a.config))
  {
    absolute.config = fs::absolute(a.config).string();
  }
  job.arguments = runArguments(absolute);
  std::istringstream options(a.slurm_options);
  for (std::string option; options >> option;)
  {
    job.options.push_back(option);
  }
  std::string list;
  for (const Recording& recording : recordings)
  {
    if (recording.path.find_first_of("#\n") != std::string::npos)
    {
      throw UserError(recording.path + ": has a # or a line break in its name; rename it");
    }
    list += recording.path + "\n";
  }
  job.tasks = arrayTasks(recordings.size());
  makeFolder(job.output + "/slurm", "choose another --output");
  writeWhole(job.list, list);
  const SubmittedJob numbers = submit(job);
  std::cout << recordings.size() << " recordings in job " << numbers.array << ", " << job.tasks
            << " tasks; job " << numbers.gather << " gathers into " << job.output
            << "/index.html; logs in " << job.output << "/slurm\n";
}

void run(const Arguments& a)
{
  std::vector<Recording> recordings = listRecordings(a.entries);
  for (const Recording& recording : recordings)
  {
    requireConverted(recording.path);
  }
  if (!a.shard.empty())
  {
    recordings = Shard::fromText(a.shard).of(recordings);
  }
  BatchSettings settings;
  settings.output = a.output;
  settings.program = programBeside("dyslam");
  settings.arguments = runArguments(a);
  settings.common = commonWork(a, settings.program);
  settings.jobs = a.jobs;
  settings.memory = static_cast<std::uint64_t>(a.memory * (1U << 30U));
  settings.scratch = a.scratch;
  settings.config = a.config;
  if (a.slurm)
  {
    return submitToSlurm(a, recordings);
  }
  const auto results =
      a.gather ? readBatch(settings, recordings) : runHere(a, settings, recordings);
  const Counts counts = countsOf(results);
  if (!a.no_summary)
  {
    makeFolder(a.output, "choose another --output");
    std::cout << '\n' << summarise(settings, results, programBeside("dyslam-eval"));
    std::cout << toText(counts) << "; " << a.output << "/index.html\n";
  }
  if (counts.done < results.size())
  {
    throw UnusableResult(toText(counts) + "; " + a.output + "/*/log.txt say why");
  }
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
