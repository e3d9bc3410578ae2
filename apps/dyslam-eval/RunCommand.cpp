// SPDX-License-Identifier: BSD-3-Clause
#include "RunCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/benchmarks/RunTables.h>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "../common/Checks.h"
#include "MetricFlags.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

struct RunArguments
{
  std::vector<std::string> folders;
  std::string truth;
  std::optional<double> interpolate;
  MetricFlags metrics;
  OutputFlags output;
};

/** The folders of runs among several, as of a pattern, with a note on each other one; a single one
 * as it is. \throws UserError if none is left. */
std::vector<std::string> runsAmong(const std::vector<std::string>& folders)
{
  if (folders.size() == 1)
  {
    return folders;
  }
  std::vector<std::string> runs;
  for (const std::string& folder : folders)
  {
    const std::string reason = whyNoRun(folder);
    if (reason.empty())
    {
      runs.push_back(folder);
      continue;
    }
    printNote(printable(folder) + ": left out: " + reason);
  }
  if (runs.empty())
  {
    throw UserError("run: none of the " + std::to_string(folders.size()) +
                    " folders is that of a run; give output folders of dyslam");
  }
  return runs;
}

/** The scores of runs; of several, those that cannot be read are left out, with a note on each.
 * \param failed their folders \throws UserError if none can be read. */
std::vector<RunScores> scoresOfAll(const std::vector<std::string>& folders,
                                   const RunArguments& a,
                                   std::vector<std::string>& failed)
{
  const auto names = shortNames(folders);
  std::vector<RunScores> runs;
  for (std::size_t i = 0; i < folders.size(); ++i)
  {
    try
    {
      RunScores scores =
          scoresOf(folders[i], a.truth, a.metrics.options(), printNote, a.interpolate);
      scores.name = names[i];
      runs.push_back(std::move(scores));
    }
    catch (const UserError& error)
    {
      failed.push_back(folders[i]);
      if (failed.size() == folders.size())
      {
        throw;
      }
      printNote(printable(folders[i]) + ": not evaluated: " + printable(error.what()));
    }
  }
  return runs;
}

void evaluateRuns(const RunArguments& a)
{
  if (!a.truth.empty() && !fs::is_directory(a.truth))
  {
    throw UserError(
        "--truth " + a.truth +
        ": is not a folder; give the .gt of a recording (errors against a file of poses: "
        "dyslam-eval trajectory)");
  }
  const auto folders = runsAmong(a.folders);
  std::vector<std::string> failed;
  const std::vector<RunScores> runs = scoresOfAll(folders, a, failed);
  a.output.write(runTable(runs), runJson(runs));
  std::cout << splitLines(runs) << truthLines(runs) << labelLines(runs) << warningLines(runs);
  if (const auto consistencies = consistenciesOf(runs); !consistencies.empty())
  {
    std::cout << '\n' << consistencyTable(consistencies).toText();
  }
  const Table stages = stageTable(runs);
  if (stages.rows() > 0)
  {
    std::cout << '\n' << stages.toText();
  }
  if (!failed.empty())
  {
    throw UserError(std::to_string(failed.size()) + " of " + counted(folders.size(), "run") +
                    " not evaluated: " + joined(failed));
  }
}
}  // namespace

Subcommand runCommand(CLI::App& app)
{
  const auto a = std::make_shared<RunArguments>();
  CLI::App* sub = app.add_subcommand(
      "run", "All metrics available for the output folders of runs, in one table");
  sub->add_option("folders", a->folders,
                  "output folders of dyslam; of several, those that are none are left out")
      ->required();
  sub->add_option("--truth", a->truth,
                  "ground-truth folder (.gt) for labels and, where the run has none, "
                  "poses; default: next to the rawlog");
  sub->add_option("--interpolate", a->interpolate,
                  "interpolate the true poses at the time stamps of the runs, between poses at "
                  "most this far from them [s]: for ground truth with other stamps")
      ->check(positive());
  a->metrics.declare(*sub);
  a->output.declare(*sub);
  return {sub, [a] { evaluateRuns(*a); }};
}
}  // namespace dyslam
