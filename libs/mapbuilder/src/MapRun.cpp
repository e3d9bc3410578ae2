// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
#include <dyslam/core/TimeRange.h>
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/mapbuilder/MapRun.h>
#include <dyslam/mapbuilder/ScanReading.h>

#include <utility>

#include "MapWriting.h"
#include "PoseReading.h"

namespace dyslam
{
namespace
{
/** Boxes know the number of their scan alone: stamps and the lidar's place are in the rawlog. */
void noteObjects(const RecordingOnTrajectory& recording, MapListener& listener, MapBuilder& builder)
{
  RawlogSource first_pass(recording.rawlog, recording.source);
  std::size_t scans = 0;
  (void)readScans(first_pass, "tracks", listener,
                  [&](const Frame& frame)
                  {
                    scans = frame.index + 1;
                    builder.noteObjects(frame);
                  });
  if (recording.source.only_first_n == 0 && recording.source.end == 0 &&
      builder.trackedScans() > scans)
  {
    listener.warn(recording.scans.tracks + ": has boxes up to scan " +
                  std::to_string(builder.trackedScans() - 1) + ", but " + recording.rawlog +
                  " has " + counted(scans, "scan") + "; are they of one recording?");
  }
}

/** What may be wrong where scans have no pose: "(scans: 10.000 to 20.000 s, poses: ...)". */
std::string withoutPoseText(double first_scan, double last_scan, const Trajectory& poses)
{
  return "(scans: " + timesFrom(first_scan, last_scan) + ", poses: " + timesOf(poses) +
         "; another clock: --time-offset; poses more than 0.5 s apart are not interpolated: "
         "--tolerance)";
}

/** Warns of a map without points, and of many scans without a pose. \param times what may be wrong
 * where scans have no pose */
void warnOfGaps(const MapReport& report,
                const RecordingOnTrajectory& recording,
                const std::string& times,
                MapListener& listener)
{
  if (report.points == 0 && report.problem.empty())
  {
    listener.warn(
        "the map has no points; check map.min_range, map.max_range, map.min_hits, map_export.area "
        "and the labels");
  }
  if (10 * report.skipped > report.scans)
  {
    listener.warn(recording.trajectory + ": has no pose for " + std::to_string(report.skipped) +
                  " of " + counted(report.scans, "scan") + ", which are not in the map; " +
                  (recording.unfinished ? "the run is unfinished"
                                        : "is it of " + recording.rawlog + "? " + times));
  }
}

/** Writes the poses of the vehicle beside maps in a frame of the user's own. \return what failed;
 * empty if nothing did */
std::string writePosesOfFixedMap(const Trajectory& poses,
                                 const RecordingOnTrajectory& recording,
                                 const MapOutputs& outputs)
{
  const std::string file = outputs.trajectoryFile();
  if (file.empty())
  {
    return {};
  }
  return writeEach({{file, [&] { writeTum(file, recording.source.levelling().recorded(poses)); }}});
}
}  // namespace

MapReport buildMap(const RecordingOnTrajectory& recording,
                   const MapBuilderOptions& options,
                   const MapOutputs& outputs,
                   MapListener& listener)
{
  requireValidExports(outputs);
  MapProducts products = productsFor(outputs);
  products.uncleaned_map = !outputs.comparison.empty();
  MapBuilder builder(options, products);
  RawlogSource source(recording.rawlog, recording.source);
  const Trajectory poses = outputs.inFixedFrame(readPoses(recording, listener));
  builder.beginRun(poses, recording.scans);
  if (!recording.scans.tracks.empty())
  {
    noteObjects(recording, listener, builder);
  }
  double last_scan = 0;  // time stamp [s]
  const std::string damage = readScansAndWarn(source, "", listener,
                                              [&](Frame frame)
                                              {
                                                last_scan = frame.scan.stamp;
                                                builder.add(std::move(frame));
                                              });
  builder.finish();
  if (!damage.empty() && source.framesRead() == 0)
  {
    throw UserError(damage);
  }
  const std::string times = withoutPoseText(builder.recorded().value_or(0), last_scan, poses);
  if (builder.keyframes() == 0)
  {
    throw UserError(recording.trajectory + ": has no pose for any scan of " + recording.rawlog +
                    "; are they of one recording? " + times);
  }
  MapReport report = writeMapOutputs(builder, outputs, listener);
  report.scans = source.framesRead();
  if (const std::string failed = writePosesOfFixedMap(poses, recording, outputs); !failed.empty())
  {
    appendWord(report.problem, failed, "; ");
  }
  warnOfGaps(report, recording, times, listener);
  if (!damage.empty())
  {
    appendWord(report.problem,
               damage + "; the map of the " + std::to_string(report.scans) +
                   " scans before it was written",
               "; ");
  }
  return report;
}
}  // namespace dyslam
