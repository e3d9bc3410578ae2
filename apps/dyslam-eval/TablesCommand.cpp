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

#include "../common/Checks.h"
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
  std::vector<std::string> methods;  //!< of --runs
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

/** The columns of --runs: HEADING=FOLDER, or a folder whose name is the heading. */
std::vector<RunColumn> methodsOf(const std::vector<std::string>& texts)
{
  std::vector<RunColumn> columns;
  std::vector<std::string> headings;
  for (const std::string& text : texts)
  {
    const bool has_heading = text.find('=') != std::string::npos;
    columns.push_back(has_heading ? columnsOf({text}, "--runs").front()
                                  : RunColumn{shortNames({text}).front(), text});
    headings.push_back(columns.back().heading);
  }
  requireDifferent("--runs", headings);
  return columns;
}

SplitColumns columnsOf(const TablesArguments& a)
{
  if (a.methods.empty())
  {
    return {a.whole, columnsOf(a.odometry, "--odometry"), columnsOf(a.labels, "--labels")};
  }
  const std::vector<RunColumn> methods = methodsOf(a.methods);
  return {methods.front().folder, methods, methods};
}

/** \throws UserError also at the end, if a run cannot be read. */
void writeTables(const TablesArguments& a)
{
  if (a.runs.empty() && a.methods.empty())
  {
    throw UserError("tables: give a folder of runs, or --runs HEADING=FOLDER ...");
  }
  const SplitColumns columns = columnsOf(a);
  const SplitRuns runs = readDrives(a.runs, columns, a.metrics.options(), printNote);
  for (const std::string& heading : columnsWithoutDrift(runs.drives, columns.odometry))
  {
    printNote(heading + ": none of its runs has t_rel and r_rel (without true poses, or shorter " +
              "than the segments of --lengths); its columns of these are left out");
  }
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
      "Tables of several drives and methods in Markdown: odometry, moving points, absolute errors, "
      "times");
  CLI::Option* folder = sub->add_option(
      "runs", a->runs,
      "folder with a run in each DRIVE/METHOD (split_tables.sh) or METHOD/DRIVE (dyslam-batch)");
  CLI::Option* methods = sub->add_option(
      "--runs", a->methods,
      "HEADING=FOLDER ...: the folders of dyslam-batch, a run in each FOLDER/DRIVE; "
      "the first is that of the whole pipeline");
  sub->add_option("--whole", a->whole, "METHOD of the whole pipeline")->capture_default_str();
  sub->add_option("--odometry", a->odometry, "columns of the odometry, HEADING=METHOD,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  sub->add_option("--labels", a->labels, "columns of the moving points, HEADING=METHOD,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->capture_default_str();
  methods->excludes(folder);
  for (const char* of_folder : {"--whole", "--odometry", "--labels"})
  {
    methods->excludes(sub->get_option(of_folder));
  }
  addOutputFile(*sub, "--markdown", a->markdown, "write the tables to this file, too");
  a->metrics.declare(*sub);
  return {sub, [a] { writeTables(*a); }};
}
}  // namespace dyslam
