// SPDX-License-Identifier: BSD-3-Clause
#include "TablesCommand.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/core/Version.h>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "../common/OutputOptions.h"
#include "MetricFlags.h"
#include "RunScores.h"
#include "SplitTables.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

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

/** Every folder with runs in it is a drive. */
std::vector<DriveScores> drivesOf(const TablesArguments& a, const std::vector<RunColumn>& columns)
{
  if (!fs::is_directory(a.runs))
  {
    throw UserError(a.runs + ": is not a folder");
  }
  std::vector<DriveScores> drives;
  for (const std::string& name : foldersIn(a.runs))
  {
    DriveScores drive;
    drive.name = name;
    for (const RunColumn& column : columns)
    {
      const fs::path folder = fs::path(a.runs) / name / column.folder;
      if (fs::is_directory(folder) && drive.runs.count(column.folder) == 0)
      {
        drive.runs.emplace(column.folder, scoresOf(folder.string(), "", a.metrics.options()));
      }
    }
    if (!drive.runs.empty())
    {
      drives.push_back(std::move(drive));
    }
  }
  if (drives.empty())
  {
    throw UserError(a.runs + ": has no DRIVE/METHOD with results of dyslam; " +
                    "scripts/split_tables.sh makes such a folder");
  }
  return drives;
}

/** Which split the drives are of: a drive of the test split among others counts. */
std::string splitLine(const std::vector<DriveScores>& drives)
{
  const DataSplits splits = DataSplits::load("splits", "splits.ini");
  std::set<std::string> names;
  for (const DriveScores& drive : drives)
  {
    const auto split = splitOf(drive.runs.begin()->second, splits);
    names.insert(split ? toString(*split) : "unknown");
  }
  std::string line;
  for (const std::string& name : names)
  {
    line += (line.empty() ? "" : ", ") + name;
  }
  return line + (names.count("test") != 0 ? " (looked at once per release)" : "");
}

std::string tablesOf(const TablesArguments& a)
{
  const std::vector<RunColumn> odometry = columnsOf(a.odometry, "--odometry");
  const std::vector<RunColumn> labels = columnsOf(a.labels, "--labels");
  std::vector<RunColumn> all = odometry;
  all.insert(all.end(), labels.begin(), labels.end());
  all.push_back({"", a.whole});
  const std::vector<DriveScores> drives = drivesOf(a, all);
  std::string lengths;
  for (const double length : a.metrics.lengths.lengths)
  {
    lengths += (lengths.empty() ? "" : ", ") + std::to_string(std::lround(length));
  }
  std::string text = "Split: " + splitLine(drives) + ". DySLAM " + DYSLAM_VERSION + ".\n\n";
  text += drivesTable(drives, a.whole).toMarkdown();
  text +=
      "\n**Odometry**: t_rel [%] and r_rel [deg/100 m] over segments of " + lengths +
      " m. The last row is the mean of the rows of the paper's Table 1, which are of other data."
      "\n\n";
  text += driftTable(drives, odometry).toMarkdown();
  text += "\n**Moving points**: IoU, precision and recall.\n\n";
  text += movingTable(drives, labels).toMarkdown();
  text += "\n**Absolute errors** of `" + a.whole + "`, before and after the graph.\n\n";
  text += absoluteTable(drives, a.whole).toMarkdown();
  text +=
      "\n**Time** per scan, mean over all scans of all drives, of the machine that made the runs. "
      "The paper's are of its Table 3.\n\n";
  text += timeTable(drives, odometry).toMarkdown();
  return text;
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
  return {sub, [a]
          {
            const std::string text = tablesOf(*a);
            std::cout << text;
            if (!a->markdown.empty())
            {
              writeWhole(a->markdown, text);
            }
          }};
}
}  // namespace dyslam
