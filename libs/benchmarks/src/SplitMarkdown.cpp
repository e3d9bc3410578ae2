// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/base/Version.h>
#include <dyslam/base/Words.h>
#include <dyslam/benchmarks/SplitTables.h>
#include <dyslam/core/TimeRange.h>

#include <algorithm>
#include <iterator>
#include <set>

namespace dyslam
{
namespace
{
/** The drives whose runs were compared with true poses. */
std::vector<DriveScores> withTruth(const std::vector<DriveScores>& drives)
{
  std::vector<DriveScores> some;
  std::copy_if(drives.begin(), drives.end(), std::back_inserter(some),
               [](const DriveScores& drive)
               {
                 return std::any_of(drive.runs.begin(), drive.runs.end(),
                                    [](const auto& run)
                                    { return run.second.trajectory || run.second.odometry; });
               });
  return some;
}

/** Names of the splits of the drives, with a remark if any drive is in the test split; empty if no
 * drive is of a split. */
std::string splitLine(const std::vector<DriveScores>& drives)
{
  const DataSplits splits = DataSplits::load("splits", "splits.ini");
  std::set<std::string> names;
  bool is_known = false;
  for (const DriveScores& drive : drives)
  {
    const auto split = splitOf(drive.runs.begin()->second, splits);
    is_known = is_known || split.has_value();
    names.insert(split ? toString(*split) : "unknown");
  }
  return !is_known
             ? ""
             : joined(names) + (names.count("test") != 0 ? " (looked at once per release)" : "");
}
}  // namespace

std::string splitMarkdown(const std::vector<DriveScores>& drives,
                          const SplitColumns& columns,
                          const std::vector<double>& segment_lengths)
{
  std::string lengths;
  for (const double length : segment_lengths)
  {
    appendWord(lengths, shortNumber(length));
  }
  const std::string split = splitLine(drives);
  std::string text = (split.empty() ? "" : "Split: " + split + ". ") + "DySLAM " + DYSLAM_VERSION +
                     ".\n\n" + drivesTable(drives, columns.whole).toMarkdown();
  const auto add = [&text](const std::string& heading, const Table& table)
  { text += table.rows() == 0 ? "" : "\n" + heading + "\n\n" + table.toMarkdown(); };
  const std::vector<DriveScores> compared = withTruth(drives);
  if (!compared.empty())
  {
    add("**Odometry**: t_rel [%] and r_rel [deg/100 m] over segments of " + lengths + " m." +
            (areKittiOdometry(drives) ? " The figures of the paper are those of its Table 1." : ""),
        driftTable(compared, columns.odometry));
    add("**Final trajectory**, after the graph: t_rel [%] and r_rel [deg/100 m] over the same "
        "segments.",
        finalDriftTable(compared, columns.odometry));
  }
  if (!split.empty())
  {
    add("Figures of the paper are of other data, KITTI odometry 00 to 10, and cannot be compared "
        "with those above: the means of the rows of its Table 1.",
        paperDriftTable(drives, columns.odometry));
  }
  add("**Moving points**: IoU, precision and recall.", movingTable(drives, columns.labels));
  if (!compared.empty())
  {
    add("**Absolute errors** of `" + columns.whole + "`, before and after the graph.",
        absoluteTable(compared, columns.whole));
  }
  Table times = timeTable(drives, columns.odometry);
  std::string of_times =
      "**Time** per scan, mean over all scans of all drives, of the machine that made the runs.";
  if (!split.empty())
  {
    addPaperTimes(times);
    of_times += " The paper's are of its Table 3.";
  }
  add(of_times, times);
  return text;
}
}  // namespace dyslam
