// SPDX-License-Identifier: BSD-3-Clause
#include "TablesCommand.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/benchmarks/SplitTables.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "../common/OutputOptions.h"
#include "MetricFlags.h"
#include "OutputFiles.h"

namespace dyslam
{
namespace
{
struct TablesArguments
{
  std::string runs;
  std::string whole = "dyslam";
  std::vector<std::string> odometry{
      "DySLAM=dyslam",       "DyLO=dylo",          "DyLO + map=dylo+refine",
      "GICP=gicp",           "LOAM=loam",          "LOAM w/o mapping=loam_no_mapping",
      "ICP-po2po=icp_po2po", "ICP-po2pl=icp_po2pl"};
  std::vector<std::string> labels{"network=network", "causal=causal", "hindsight=dyslam"};
  std::string markdown;
  MetricFlags metrics;
};

std::vector<RunColumn> columnsOf(const std::vector<std::string>& texts, const std::string& flag)
{
  std::vector<RunColumn> columns;
  for (const std::string& text : texts)
  {
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    {
      throw UserError(flag + ": '" + text + "' is no HEADING=FOLDER");
    }
    columns.push_back({text.substr(0, equals), text.substr(equals + 1)});
  }
  return columns;
}

/** \throws UserError also at the end, if a run cannot be read. */
void writeTables(const TablesArguments& a)
{
  const SplitColumns columns{a.whole, columnsOf(a.odometry, "--odometry"),
                             columnsOf(a.labels, "--labels")};
  const SplitRuns runs = readDrives(a.runs, columns, a.metrics.options(), printNote);
  const std::string text = splitMarkdown(runs.drives, columns, a.metrics.lengths.lengths);
  std::cout << text;
  if (!a.markdown.empty())
  {
    writeWhole(a.markdown, text);
  }
  if (!runs.failed.empty())
  {
    throw UserError("the tables are without " + counted(runs.failed.size(), "run") +
                    " that cannot be read: " + joined(runs.failed));
  }
}
}  // namespace

Subcommand tablesCommand(CLI::App& app)
{
  const auto a = std::make_shared<TablesArguments>();
  CLI::App* sub = app.add_subcommand(
      "tables",
      "The tables of a split in Markdown: odometry, moving points, absolute errors, times");
  sub->add_option("runs", a->runs, "folder with a run in each DRIVE/METHOD (split_tables.sh)")
      ->required();
  sub->add_option("--whole", a->whole, "METHOD of the whole pipeline")->capture_default_str();
  sub->add_option("--odometry", a->odometry, "columns of the odometry, HEADING=METHOD,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  sub->add_option("--labels", a->labels, "columns of the moving points, HEADING=METHOD,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  addOutputFile(*sub, "--markdown", a->markdown, "write the tables to this file, too");
  a->metrics.declare(*sub);
  return {sub, [a] { writeTables(*a); }};
}
}  // namespace dyslam
