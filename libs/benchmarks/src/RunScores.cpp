// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Config.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/RunScores.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/formats/MotionFiles.h>
#include <dyslam/formats/RunFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/RawlogSource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "PairNote.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

constexpr double stamp_tolerance = 1e-3;  // all files of a run contain the scans' stamps [s]

void readReport(const fs::path& folder, const NoteSink& note, RunScores& scores)
{
  const fs::path path = folder / run_files::report;
  if (!fs::exists(path))
  {
    note(folder.string() + " has no report.json: the run did not finish");
    return;
  }
  scores.report_text = readWhole(path.string());
  scores.report = parseRunReport(scores.report_text, path.string());
  for (const std::string& reason : scores.report.not_written)
  {
    note(folder.string() + " lacks a file: " + printable(reason));
  }
}

/** Number of a recording's scans that the run's settings use. \param recorded number of all scans
 */
std::size_t scansTaken(const fs::path& folder, const Trajectory& recorded)
{
  RawlogSourceOptions input;
  if (const fs::path ini = folder / run_files::settings; fs::exists(ini))
  {
    load(input, Config::fromFile(ini.string()), "input");
  }
  ScanSelection selection(input);
  std::size_t taken = 0;
  for (std::size_t i = 0; i < recorded.size(); ++i)
  {
    taken += selection.takes(i, recorded[i].stamp) ? 1U : 0U;
  }
  const auto most = static_cast<std::size_t>(input.only_first_n);
  return most > 0 ? std::min(taken, most) : taken;
}

/** Notes the progress of a run that was stopped or killed, or whose recording is damaged.
 * \return whether the run is such a run */
bool noteUnfinished(const std::string& folder,
                    const RunReport& report,
                    const std::string& truth,
                    const NoteSink& note)
{
  if (report.finished)
  {
    return false;
  }
  std::string scans = report.frames ? counted(*report.frames, "scan") : "? scans";
  const fs::path poses = fs::path(truth) / true_poses_file;
  if (!truth.empty() && fs::exists(poses))
  {
    scans = (report.frames ? std::to_string(*report.frames) : "?") + " of " +
            counted(scansTaken(folder, readTum(poses.string())), "scan");
  }
  const std::string& reason = report.ended_early;
  note(folder + ": unfinished: " + scans + (reason.empty() ? "" : "; " + printable(reason)) +
       (fs::exists(fs::path(folder) / run_files::state)
            ? "; continue with: dyslam --resume -o " + shellWord(folder)
            : ""));
  return true;
}

/** File of the true poses: in the run's folder, else in the ground-truth folder; may not exist. */
fs::path referenceOf(const fs::path& folder, const std::string& truth)
{
  const fs::path own = folder / run_files::reference;
  return fs::exists(own) || truth.empty() ? own : fs::path(truth) / true_poses_file;
}

/** Origin of the poses of referenceOf(): as the run recorded it, else as stated in the ground-truth
 * folder of its recording or in the given one. */
PoseOrigin originOf(const fs::path& folder,
                    const RunReport& report,
                    const std::string& beside_rawlog,
                    const std::string& given_truth)
{
  PoseOrigin origin;
  if (fs::exists(folder / run_files::reference))
  {
    origin = report.ground_truth.value_or(PoseOrigin());
    if (origin.source == PoseSource::unknown && !beside_rawlog.empty())
    {
      origin = poseOrigin(beside_rawlog);
    }
  }
  return origin.source == PoseSource::unknown && !given_truth.empty() ? poseOrigin(given_truth)
                                                                      : origin;
}

/** Whether two trajectories have a time in common. */
bool overlap(const Trajectory& a, const Trajectory& b)
{
  return a.size() > 0 && b.size() > 0 && a[0].stamp <= b[b.size() - 1].stamp &&
         b[0].stamp <= a[a.size() - 1].stamp;
}

/** Pairs with the true poses; nothing, with a note, if the run has no or too little ground truth.
 * \param interpolate see scoresOf() */
std::optional<PosePairs> pairsOf(const fs::path& estimate,
                                 const fs::path& reference,
                                 const std::optional<double>& interpolate,
                                 const NoteSink& note)
{
  if (!fs::exists(reference) || !fs::exists(estimate))
  {
    return std::nullopt;
  }
  const Trajectory truth = readTum(reference.string());
  const Trajectory poses = readTum(estimate.string());
  PosePairs pairs = interpolate ? associateInterpolated(truth, poses, *interpolate)
                                : associateByTime(truth, poses, stamp_tolerance);
  if (pairs.size() < 2)
  {
    const std::string of_all =
        std::to_string(pairs.size()) + " of " + std::to_string(pairs.estimate_size) + " poses ";
    note(estimate.string() + ": " + of_all +
         (interpolate ? "have poses of the ground truth within --interpolate " +
                            shortNumber(*interpolate) + " s before and after them"
                      : "match a time stamp of the ground truth") +
         ", 2 are needed: no errors computed" +
         (!interpolate && overlap(truth, poses)
              ? "; --interpolate 0.5 interpolates the ground truth at the time stamps of the poses"
              : ""));
    return std::nullopt;
  }
  return pairs;
}

/** Errors of the trajectory and of the odometry, with a note if the ground truth covers only a
 * part. */
void evaluatePoses(const fs::path& folder,
                   const fs::path& reference,
                   const TrajectoryMetricsOptions& metrics,
                   const std::optional<double>& interpolate,
                   const NoteSink& note,
                   RunScores& scores)
{
  const std::string trajectory = (folder / run_files::trajectory).string();
  const std::string odometry = (folder / run_files::odometry).string();
  if (const auto pairs = pairsOf(trajectory, reference, interpolate, note))
  {
    noteFewPairs(*pairs, trajectory, reference.string(),
                 shortNumber(interpolate.value_or(stamp_tolerance)), note);
    scores.trajectory = evaluateTrajectory(trajectory, *pairs, metrics);
    for (std::size_t i = 0; i < pairs->size(); ++i)
    {
      scores.true_poses.push_back(pairs->stamps[i], pairs->reference[i]);
    }
    if (const auto of_odometry = pairsOf(odometry, reference, interpolate, note))
    {
      scores.odometry = evaluateTrajectory(odometry, *of_odometry, metrics);
    }
  }
}

/** Consistency of the odometry; nothing if the run does not state its covariances. */
std::optional<OdometryConsistency> evaluateConsistency(const fs::path& folder,
                                                       const fs::path& reference)
{
  const fs::path motions = folder / run_files::motions;
  const fs::path odometry = folder / run_files::odometry;
  if (!fs::exists(motions) || !fs::exists(odometry))
  {
    return std::nullopt;
  }
  const PosePairs pairs =
      associateByTime(readTum(reference.string()), readTum(odometry.string()), stamp_tolerance);
  return odometryConsistency(pairs, readMotionFile(motions.string()), stamp_tolerance);
}

/** Whether the run's settings decide the labels with hindsight; nothing if effective.ini is
 * missing, damaged (with a note), or does not state it. */
std::optional<bool> hasHindsightLabels(const fs::path& folder, const NoteSink& note)
{
  const fs::path ini = folder / run_files::settings;
  if (!fs::exists(ini))
  {
    return std::nullopt;
  }
  try
  {
    const auto text = Config::fromFile(ini.string()).text("labels", "hindsight");
    return text ? std::optional<bool>(*text == "true") : std::nullopt;
  }
  catch (const UserError& error)
  {
    note(folder.string() +
         ": whether its labels are with hindsight is not known: " + printable(error.what()));
    return std::nullopt;
  }
}

/** Ground-truth folder: as given, or next to the recording of the run. */
std::string truthFolder(const std::string& given,
                        const std::string& folder,
                        const RunReport& report)
{
  return !given.empty()         ? given
         : report.input.empty() ? ""
                                : groundTruthFolder(recordingOf(report, folder));
}

/** Whether a folder has output folders of runs in it. */
bool hasRuns(const std::string& folder)
{
  const auto entries = entriesIfReadable(folder);
  return std::any_of(entries.begin(), entries.end(),
                     [](const fs::directory_entry& entry)
                     { return fs::exists(entry.path() / run_files::trajectory); });
}
}  // namespace

bool RunScores::odometryIsFinal() const
{
  if (!trajectory || !odometry)
  {
    return true;
  }
  constexpr double rounding = 1e-6;  // of the digits in the files
  const auto isSame = [](double a, double b) { return std::abs(a - b) <= rounding; };
  const TrajectoryReport& a = *trajectory;
  const TrajectoryReport& b = *odometry;
  return isSame(a.absolute.translation.rmse, b.absolute.translation.rmse) &&
         isSame(a.absolute.rotation_deg.rmse, b.absolute.rotation_deg.rmse) &&
         isSame(a.relative.translation.rmse, b.relative.translation.rmse) &&
         isSame(a.end.translation, b.end.translation) && a.pairs == b.pairs;
}

std::string whyNoRun(const std::string& folder)
{
  if (!fs::is_directory(folder))
  {
    return "is not a folder";
  }
  if (fs::exists(fs::path(folder) / run_files::trajectory))
  {
    return "";
  }
  return fs::exists((fs::path(folder) / run_files::odometry).string() + ".tmp")
             ? "unfinished, without a checkpoint: has no trajectory_tum.txt"
         : hasRuns(folder) ? "is a folder of runs, not that of one; give those in it"
                           : "has no trajectory_tum.txt: is it the output folder of a run?";
}

RunScores scoresOf(const std::string& folder,
                   const std::string& given_truth,
                   const TrajectoryMetricsOptions& metrics,
                   const NoteSink& note,
                   const std::optional<double>& interpolate)
{
  if (const std::string reason = whyNoRun(folder); !reason.empty())
  {
    throw UserError(folder + ": " + reason);
  }
  RunScores scores;
  readReport(folder, note, scores);
  const std::string truth = truthFolder(given_truth, folder, scores.report);
  const fs::path reference = referenceOf(folder, given_truth);
  evaluatePoses(folder, reference, metrics, interpolate, note, scores);
  if (scores.trajectory)
  {
    scores.truth =
        originOf(folder, scores.report, truthFolder("", folder, scores.report), given_truth);
    if (scores.truth.isExact() && !interpolate)
    {
      scores.consistency = evaluateConsistency(folder, reference);
    }
  }
  else if (!fs::exists(reference))
  {
    note(folder + " has no reference_tum.txt" +
         (given_truth.empty()
              ? ": its recording has no ground truth to compare the trajectory with "
                "(dyslam-eval trajectory compares it with a file of poses)"
              : ", " + given_truth + " no poses_tum.txt: no errors computed"));
  }
  scores.world = simulatedWorld(truth);
  const bool unfinished = noteUnfinished(folder, scores.report, truth, note);
  const fs::path labels = fs::path(folder) / run_files::labels;
  if (fs::is_directory(labels) && !(unfinished && fs::is_empty(labels)))
  {
    if (!truth.empty() && fs::is_directory(fs::path(truth) / "labels"))
    {
      try
      {
        scores.labels = compareLabelFolders(truth, folder);
        scores.labels_with_hindsight = hasHindsightLabels(folder, note);
      }
      catch (const UserError& error)  // the other runs are evaluated all the same
      {
        note(folder + ": labels not evaluated against " + truth + ": " + error.what());
      }
    }
    else
    {
      note(folder + ": labels not evaluated: " +
           (fs::is_directory(truth) ? truth + " has no labels/"
                                    : "no ground truth known (--truth)"));
    }
  }
  return scores;
}

std::optional<Split> splitOf(const RunScores& scores, const DataSplits& splits)
{
  return scores.world ? splits.splitOfSeed(scores.world->seed) : std::nullopt;
}
}  // namespace dyslam
