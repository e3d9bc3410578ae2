// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Statistics.h>
#include <dyslam/benchmarks/TrajectoryComparison.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/eval/Axes.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/PositionFile.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/io/Conversion.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "MetricPositions.h"
#include "PairNote.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

/** Reads the poses of a file; poses of a camera are converted to poses of the lidar. */
TrajectoryFile readPoses(const std::string& path, bool camera, const std::string& calib)
{
  TrajectoryFile file = readTrajectory(path);
  if (camera)
  {
    const Pose T_cam_velo = calib.empty() ? cameraAxes() : readKittiCalib(calib).T_cam_velo;
    std::vector<Pose> poses;
    for (const StampedPose& pose : file.trajectory)
    {
      poses.push_back(pose.pose);
    }
    poses = posesOfMountedSensor(poses, T_cam_velo);
    for (std::size_t i = 0; i < poses.size(); ++i)
    {
      file.trajectory[i].pose = poses[i];
    }
  }
  return file;
}

/** Gives the poses of a KITTI file the times of another one; those without a time are left out.
 * \throws UserError. */
void setTimes(TrajectoryFile& file, const std::string& path, const std::string& times_path)
{
  if (file.format == TrajectoryFormat::tum)
  {
    throw UserError(path + ": has time stamps of its own; leave --reference-times out");
  }
  const std::vector<double> times = readTimesOrTimestamps(times_path);
  if (times.size() != file.trajectory.size())
  {
    throw UserError(times_path + ": has " + counted(times.size(), "time") + " for " +
                    counted(file.trajectory.size(), "pose") + " of " + path +
                    "; a time for each line is needed");
  }
  Trajectory timed;
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    if (!std::isfinite(times[i]))
    {
      continue;  // a scan that KITTI lost
    }
    if (!timed.empty() && times[i] <= timed[timed.size() - 1].stamp)
    {
      throw UserError(times_path + ": its times do not ascend (number " + std::to_string(i + 1) +
                      ")");
    }
    timed.push_back(times[i], file.trajectory[i].pose);
  }
  file = {std::move(timed), TrajectoryFormat::tum};
}

/** Reads the reference as poses of the estimate's body. */
TrajectoryFile readReference(const std::string& path, const PoseReading& a)
{
  TrajectoryFile file = readPoses(path, a.camera == "reference", a.calib);
  if (!a.reference_times.empty())
  {
    setTimes(file, path, a.reference_times);
  }
  if (!a.reference_body.empty())
  {
    const Pose T_reference_estimate =
        poseFromOption("--reference-body", a.reference_body).inverse();
    for (std::size_t i = 0; i < file.trajectory.size(); ++i)
    {
      file.trajectory[i].pose = file.trajectory[i].pose * T_reference_estimate;
    }
  }
  return file;
}

/** Reads the poses of the estimate, with its time stamps on the clock of the reference. */
TrajectoryFile readEstimate(const std::string& path, const PoseReading& a)
{
  TrajectoryFile file = readPoses(path, a.camera == "estimate", a.calib);
  for (std::size_t i = 0; i < file.trajectory.size(); ++i)
  {
    file.trajectory[i].stamp += a.time_offset.value_or(0);
  }
  return file;
}

/** \throws UserError for a single pose: errors are of the motion between two. */
void requireTwoPoses(const Trajectory& trajectory, const std::string& path)
{
  if (trajectory.size() < 2)
  {
    throw UserError(path + ": has one pose; errors need two or more");
  }
}

struct NamedTrajectory
{
  std::string path;  //!< of its file
  Trajectory trajectory;
  bool positions_only = false;  //!< its rotations mean nothing
};

/** What may help if stamps of two trajectories do not match. */
std::string pairingAdvice(const Trajectory& reference,
                          const Trajectory& estimate,
                          const PoseReading& a)
{
  const bool overlap = estimate[0].stamp <= reference[reference.size() - 1].stamp &&
                       reference[0].stamp <= estimate[estimate.size() - 1].stamp;
  return overlap && !a.interpolate
             ? "--interpolate is for a reference whose stamps are not those of the estimate"
             : "--time-offset is added to the estimate's";
}

/** Length of the reference's path between successive pairs [m], without the gaps between them: of
 * more than a second and five times the median step. */
double coveredLength(const PosePairs& pairs,
                     const Trajectory& reference,
                     const std::vector<double>& lengths)
{
  std::vector<double> steps;
  for (std::size_t i = 1; i < pairs.size(); ++i)
  {
    steps.push_back(pairs.stamps[i] - pairs.stamps[i - 1]);
  }
  constexpr double least_gap = 1;  // [s]
  constexpr double least_steps = 5;
  const double longest = std::max(least_gap, least_steps * statisticsOf(steps).median);
  const auto travelled = [&](double stamp)
  { return lengths[std::min(reference.firstNotBefore(stamp), reference.size() - 1)]; };
  double covered = 0;
  for (std::size_t i = 0; i < steps.size(); ++i)
  {
    if (steps[i] <= longest)
    {
      covered += travelled(pairs.stamps[i + 1]) - travelled(pairs.stamps[i]);
    }
  }
  return covered;
}

/** Notes if the errors are those of a part of the reference's path: the estimate begins later, ends
 * earlier or has gaps. */
void notePartOfPath(const PosePairs& pairs,
                    const NamedTrajectory& reference,
                    const std::string& estimate,
                    const NoteSink& note)
{
  constexpr double whole = 0.95;  // least share of the path
  constexpr double shortest = 1;  // shorter paths are mostly noise [m]
  const std::vector<double> lengths = reference.trajectory.pathLengths();
  const double covered = coveredLength(pairs, reference.trajectory, lengths);
  if (lengths.back() > shortest && covered < whole * lengths.back())
  {
    note(formatted("%s: has poses along %.1f of the %.1f m of %s; the errors are of this part",
                   estimate.c_str(), covered, lengths.back(), reference.path.c_str()));
  }
}

/** Pairs poses by their time stamps. */
PosePairs pairByTime(const NamedTrajectory& reference,
                     const NamedTrajectory& estimate,
                     const PoseReading& a,
                     const NoteSink& note)
{
  requireTwoPoses(reference.trajectory, reference.path);
  requireTwoPoses(estimate.trajectory, estimate.path);
  const double tolerance = a.tolerance.value_or(PoseReading::default_tolerance);
  const std::string limit = a.interpolate ? "--interpolate " + shortNumber(*a.interpolate)
                                          : "--tolerance " + shortNumber(tolerance);
  PosePairs pairs =
      a.interpolate
          ? associateInterpolated(reference.trajectory, estimate.trajectory, *a.interpolate)
          : associateByTime(reference.trajectory, estimate.trajectory, tolerance);
  pairs.positions_only = reference.positions_only;
  if (pairs.size() < 2)
  {
    throw UserError(estimate.path + ": only " + std::to_string(pairs.size()) + " of " +
                    std::to_string(pairs.estimate_size) + " time stamps are within " + limit +
                    " s of one in " + reference.path + " (" + timesOf(estimate.trajectory) +
                    " and " + timesOf(reference.trajectory) + "; " +
                    pairingAdvice(reference.trajectory, estimate.trajectory, a) + ")");
  }
  noteFewPairs(pairs, estimate.path, reference.path, limit, note);
  notePartOfPath(pairs, reference, estimate.path, note);
  return pairs;
}

/** Pairs the poses of the reference's body with its positions. */
PosePairs pairWithPositions(const std::string& reference_path,
                            const std::string& estimate_path,
                            const PoseReading& a,
                            const NoteSink& note)
{
  if (a.camera == "reference" || !a.reference_times.empty())
  {
    throw UserError(reference_path + ": has times and positions alone; leave " +
                    (a.camera == "reference" ? "--camera reference" : "--reference-times") +
                    " out");
  }
  const Pose T_estimate_reference = poseFromOption("--reference-body", a.reference_body);
  if (!T_estimate_reference.linear().isIdentity(0))
  {
    throw UserError("--reference-body '" + a.reference_body + "': " + reference_path +
                    " has positions alone; the three angles must be 0");
  }
  TrajectoryFile estimate = readEstimate(estimate_path, a);
  if (estimate.format == TrajectoryFormat::kitti)
  {
    throw UserError(estimate_path +
                    ": has no time stamps (KITTI), by which positions are paired; give a TUM file");
  }
  for (std::size_t i = 0; i < estimate.trajectory.size(); ++i)
  {
    estimate.trajectory[i].pose = estimate.trajectory[i].pose * T_estimate_reference;
  }
  return pairByTime({reference_path, readMetricPositions(reference_path, note), true},
                    {estimate_path, estimate.trajectory}, a, note);
}

/** \throws UserError if flags for time stamps are given with a file that has none. */
void requireNoTimeFlags(const PoseReading& a, const std::string& file)
{
  const std::string flag = a.tolerance                  ? "--tolerance"
                           : a.interpolate              ? "--interpolate"
                           : a.time_offset              ? "--time-offset"
                           : !a.reference_times.empty() ? "--reference-times"
                                                        : "";
  if (!flag.empty())
  {
    throw UserError(file +
                    ": has no time stamps (KITTI), its poses are paired line by line; leave " +
                    flag + " out, or give a TUM file");
  }
}

/** Pairs poses of both files, those of a camera only if `a.camera` says so. */
PosePairs pairPoses(const std::string& reference_path,
                    const std::string& estimate_path,
                    const PoseReading& a,
                    const NoteSink& note)
{
  const TrajectoryFile reference = readReference(reference_path, a);
  const TrajectoryFile estimate = readEstimate(estimate_path, a);
  if (reference.format == TrajectoryFormat::tum && estimate.format == TrajectoryFormat::tum)
  {
    return pairByTime({reference_path, reference.trajectory}, {estimate_path, estimate.trajectory},
                      a, note);
  }
  requireTwoPoses(reference.trajectory, reference_path);
  requireTwoPoses(estimate.trajectory, estimate_path);
  requireNoTimeFlags(a,
                     reference.format == TrajectoryFormat::kitti ? reference_path : estimate_path);
  if (reference.trajectory.size() != estimate.trajectory.size())
  {
    note(estimate_path + " has " + counted(estimate.trajectory.size(), "pose") + ", " +
         reference_path + " " + std::to_string(reference.trajectory.size()) +
         "; without time stamps they are associated by index" +
         (estimate.format == TrajectoryFormat::tum
              ? " (--reference-times gives those of the reference)"
              : ""));
  }
  PosePairs pairs = associateByIndex(reference.trajectory, estimate.trajectory);
  pairs.reference_has_quaternions = reference.format == TrajectoryFormat::tum;
  pairs.estimate_has_quaternions = estimate.format == TrajectoryFormat::tum;
  return pairs;
}

/** The calib.txt of the sequence that the poses are of: beside sequences/NN/poses.txt, or in
 * sequences/NN of poses/NN.txt; empty if there is none. */
std::string calibOfSequence(const std::string& poses)
{
  const fs::path file(poses);
  for (const fs::path& folder :
       {file.parent_path(), file.parent_path() / ".." / "sequences" / file.stem()})
  {
    const fs::path calib = folder / "calib.txt";
    if (fs::is_regular_file(calib))
    {
      return calib.lexically_normal().string();
    }
  }
  return "";
}

/** How files are read of which one has the poses of a camera. \param is_estimate which one */
PoseReading asCamera(PoseReading a,
                     bool is_estimate,
                     const std::string& reference,
                     const std::string& estimate)
{
  a.camera = is_estimate ? "estimate" : "reference";
  for (const std::string& poses : {is_estimate ? estimate : reference, reference})
  {
    a.calib = a.calib.empty() ? calibOfSequence(poses) : a.calib;
  }
  return a;
}

/** Says that poses of a camera are converted. \param path their file \param calib calibration that
 * they are converted with; may be empty */
void noteCamera(const std::string& path, const std::string& calib, const NoteSink& note)
{
  note(path + ": has the poses of a camera (z ahead), which are converted to the lidar's " +
       (calib.empty() ? "by the axes alone; --calib calib.txt gives its mounting"
                      : "with " + calib) +
       " (--camera none: as they are)");
}

/** Pairs poses of which `a.camera` states whether they are a camera's. */
PosePairs pairAsStated(const std::string& reference,
                       const std::string& estimate,
                       const PoseReading& a,
                       const NoteSink& note)
{
  return isPositionFile(reference) ? pairWithPositions(reference, estimate, a, note)
                                   : pairPoses(reference, estimate, a, note);
}
}  // namespace

PosePairs pairFiles(const std::string& reference,
                    const std::string& estimate,
                    const PoseReading& a,
                    const NoteSink& note)
{
  if (a.camera == "estimate" || a.camera == "reference")
  {
    const bool is_estimate = a.camera == "estimate";
    const PoseReading reading = asCamera(a, is_estimate, reference, estimate);
    PosePairs pairs = pairAsStated(reference, estimate, reading, note);
    noteCamera(is_estimate ? estimate : reference, reading.calib, note);
    return pairs;
  }
  PosePairs pairs = pairAsStated(reference, estimate, a, note);
  if (pairs.positions_only || !a.camera.empty() || !a.reference_body.empty())
  {
    return pairs;
  }
  const BodyAxes axes = compareBodyAxes(pairs);
  const bool is_estimate = axes == BodyAxes::estimate_camera;
  if (!is_estimate && axes != BodyAxes::reference_camera)
  {
    if (!a.calib.empty())
    {
      note("--calib " + a.calib + ": is not used, as " + estimate + " and " + reference +
           " have the same axes");
    }
    return pairs;
  }
  const PoseReading reading = asCamera(a, is_estimate, reference, estimate);
  noteCamera(is_estimate ? estimate : reference, reading.calib, note);
  return pairPoses(reference, estimate, reading, [](const std::string&) {});
}

PathSummary readPath(const std::string& path, const PoseReading& a, const NoteSink& note)
{
  const bool is_camera = a.camera == "estimate";
  const std::string calib = is_camera ? asCamera(a, true, path, path).calib : "";
  TrajectoryFile file = readPoses(path, is_camera, calib);
  if (is_camera)
  {
    noteCamera(path, calib, note);
  }
  PathSummary summary;
  summary.trajectory = std::move(file.trajectory);
  const StampedPose& first = summary.trajectory[0];
  const StampedPose& last = summary.trajectory[summary.trajectory.size() - 1];
  if (file.format == TrajectoryFormat::tum)
  {
    summary.duration = last.stamp - first.stamp;
  }
  summary.length = summary.trajectory.pathLengths().back();
  summary.start_to_end = (last.pose.translation() - first.pose.translation()).norm();
  return summary;
}
}  // namespace dyslam
