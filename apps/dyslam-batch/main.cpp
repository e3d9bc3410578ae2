// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/batch/Batch.h>
#include <dyslam/batch/Summary.h>
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
#include "../common/Shard.h"
#include "../common/StopSignals.h"
#include "Arguments.h"
#include "Slurm.h"

namespace
{
namespace fs = std::filesystem;
using namespace dyslam;
using namespace dyslam::batch;

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

/** One line on stdout about a recording that has ended. */
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
    const std::string figures = formatted(", %.1f s, %.2f GiB", m.seconds,
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

void run(const Arguments& a)
{
  const auto note = [&a](const std::string& text)
  {
    if (!a.quiet)
    {
      std::cerr << "note: " << printable(text) << '\n';
    }
  };
  std::vector<Recording> recordings = listRecordings(a.entries, note);
  requireFittingConversion(a.conversion, recordings);
  if (!a.shard.empty())
  {
    recordings = Shard::fromText(a.shard).of(recordings);
  }
  BatchSettings settings;
  settings.output = a.output;
  settings.program = programBeside("dyslam");
  settings.arguments = runArguments(a);
  settings.conversion = a.conversion.words();
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
