// SPDX-License-Identifier: BSD-3-Clause
#include "RunMerging.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/GroundTruth.h>
#include <dyslam/mapbuilder/ScanReading.h>
#include <dyslam/mapping/MovingInMap.h>

#include <limits>
#include <string>

namespace dyslam
{
namespace
{
/** Static points of a keyframe: by labels, else outside the boxes of tracked objects. */
std::vector<Eigen::Vector3f> staticPoints(const RunScans& scans,
                                          const StaticMapOptions& map,
                                          Frame& frame,
                                          const Pose& pose)
{
  frame.T_odom_vehicle = pose;
  scans.fillCloud(frame);
  scans.fillMoving(frame);
  for (TrackedObject& object : frame.objects)
  {
    object.dynamic = true;
  }
  const std::vector<bool> moving = movingInMap(frame, map);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < frame.cloud.size(); ++i)
  {
    if (!moving[i])
    {
      points.push_back(frame.cloud.points[i]);
    }
  }
  return points;
}

/** Number of each keyframe's scan in the run's trajectory, which has a pose for every scan. */
std::vector<std::size_t> keyframeScans(const RunFolder& run)
{
  constexpr double any_distance = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> scans;
  for (const double stamp : run.keyframe_stamps)
  {
    scans.push_back(run.trajectory.nearest(stamp, any_distance).value());
  }
  return scans;
}

/** \return the ground truth of its recording */
Trajectory addRun(const RunFolder& run,
                  const StaticMapOptions& map,
                  ThreadPool& pool,
                  MapListener& listener,
                  RunMerger& merger)
{
  merger.addRun(run.graph, run.references);
  const RunScans scans(run.trajectory, run.scans, pool);
  RawlogSource source(run.rawlog, run.source);
  Trajectory truth;
  const std::vector<std::size_t> keyframe_scans = keyframeScans(run);
  std::size_t next = 0;
  bool found = false;
  const std::string damage = readScans(
      source, run.name, listener,
      [&](Frame frame)
      {
        if (frame.T_world_vehicle_truth)
        {
          truth.push_back(frame.scan.stamp, *frame.T_world_vehicle_truth);
        }
        const auto scan = run.trajectory.nearest(frame.scan.stamp, run.scans.tolerance);
        while (scan && next < keyframe_scans.size() && keyframe_scans[next] < *scan)
        {
          merger.addKeyframe({});  // its scan is not in the recording any more
          ++next;
        }
        const auto pose = scans.poseOf(frame);
        if (pose && scan && next < keyframe_scans.size() && keyframe_scans[next] == *scan)
        {
          merger.addKeyframe(scans.isRegistered(frame) ? staticPoints(scans, map, frame, *pose)
                                                       : std::vector<Eigen::Vector3f>());
          ++next;
          found = true;
        }
      });
  if (!found)
  {
    throw UserError(run.rawlog + ": " +
                    (damage.empty() ? "has none of the keyframes of " + run.folder +
                                          "; is it the recording of that run?"
                                    : damage));
  }
  for (; next < keyframe_scans.size(); ++next)
  {
    merger.addKeyframe({});
  }
  return truth;
}

/** Whether the true poses of both are in one frame: simulated in one world. Those of a drive with
 * GNSS/INS, say, begin at its own start. */
bool haveCommonFrame(const RunFolder& a, const RunFolder& b)
{
  const auto world_a = simulatedWorld(groundTruthFolder(a.rawlog));
  const auto world_b = simulatedWorld(groundTruthFolder(b.rawlog));
  return world_a && world_b && world_a->world == world_b->world && world_a->seed == world_b->seed;
}
}  // namespace

MergedRuns mergeRuns(const std::vector<RunFolder>& runs,
                     const RunMergerConfig& config,
                     const StaticMapOptions& map,
                     int threads,
                     MapListener& listener)
{
  ThreadPool pool(threads);
  RunMerger merger(config);
  MergedRuns result;
  for (const RunFolder& run : runs)
  {
    result.truth.push_back(addRun(run, map, pool, listener, merger));
    if (&run != &runs.front() && !haveCommonFrame(runs.front(), run))
    {
      result.truth.back() = Trajectory();
    }
  }
  result.merge = merger.merge();
  return result;
}

Trajectory mergedTrajectory(const RunFolder& run, const std::vector<Pose>& merged)
{
  Trajectory result;
  std::size_t k = 0;
  const std::size_t last = merged.size() - 1;
  for (const auto& [stamp, pose] : run.trajectory)
  {
    while (k < last && run.keyframe_stamps[k + 1] <= stamp)
    {
      ++k;
    }
    const auto from = [&](std::size_t keyframe, const Pose& T)
    { return Pose(merged[keyframe] * run.graph.pose(Key::ego(keyframe)).inverse() * T); };
    Pose corrected = from(k, pose);
    if (k < last && stamp > run.keyframe_stamps[k])
    {
      const double span = run.keyframe_stamps[k + 1] - run.keyframe_stamps[k];
      corrected =
          interpolate(corrected, from(k + 1, pose), (stamp - run.keyframe_stamps[k]) / span);
    }
    result.push_back(stamp, orthonormalised(corrected));
  }
  return result;
}
}  // namespace dyslam
