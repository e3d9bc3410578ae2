// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Printable.h>
#include <dyslam/core/Frame.h>
#include <dyslam/formats/ScanTable.h>

#include <algorithm>
#include <cmath>

#include "CsvTable.h"

namespace dyslam
{
namespace
{
/** Fields of a result of the scan matcher, with commas. A motion without inliers was not measured:
 * there is no scan before, or the method uses no points; then `converged` and the figures of the
 * inliers are empty. */
std::string matcherFields(const Frame& frame)
{
  const MotionEstimate& odometry = frame.odometry;
  const int accepted = frame.odometry_accepted ? 1 : 0;
  if (odometry.registered() && odometry.inliers == 0)
  {
    return formatted(",%d,,,", accepted);
  }
  return formatted("%d,%d,%zu,%.4f,", odometry.registered() ? 1 : 0, accepted, odometry.inliers,
                   odometry.rmse);
}
}  // namespace

std::string scanTableHeader()
{
  return "frame,stamp,points,moving_points,odometry_converged,odometry_accepted,odometry_inliers,"
         "odometry_rmse,odometry_rejection,registered,inliers,rmse,reason,forward,turn_deg,"
         "keyframe\n";
}

std::string scanTableRow(const Frame& frame)
{
  const MotionEstimate& motion = frame.motion;
  std::string row =
      formatted("%zu,%.9f,%zu,%td,", frame.index, frame.scan.stamp, frame.cloud.size(),
                std::count(frame.moving.begin(), frame.moving.end(), true)) +
      matcherFields(frame) + csvField(frame.odometry_rejection);
  row += formatted(",%d,%zu,%.4f,", motion.registered() ? 1 : 0, motion.inliers, motion.rmse) +
         csvField(motion.reason);
  const Pose& step = motion.T_previous_current;
  return row + formatted(",%.4f,%.4f,%d\n", step.translation().x(),
                         rotationAngle(step) * 180 / M_PI, frame.is_keyframe ? 1 : 0);
}

std::vector<std::size_t> scansOfTable(const std::string& path)
{
  CsvTable file(path);
  const std::size_t frame = file.column("frame");
  std::vector<std::size_t> scans;
  while (file.next())
  {
    scans.push_back(file.count(frame));
  }
  return scans;
}

std::set<std::size_t> unregisteredScans(const std::string& path)
{
  CsvTable file(path);
  const std::size_t frame = file.column("frame");
  const std::size_t registered = file.column("registered");
  std::set<std::size_t> scans;
  while (file.next())
  {
    const std::size_t scan = file.count(frame);
    if (file.text(registered) == "0")
    {
      scans.insert(scan);
    }
  }
  return scans;
}

std::string scanPartsHeader()
{
  return "frame,sensor_label,stamp,first_point,points\n";
}

std::string scanPartRows(const Frame& frame)
{
  const Scan& scan = frame.scan;
  std::string rows;
  for (std::size_t i = 0; i < scan.parts.size(); ++i)
  {
    const ScanPart& part = scan.parts[i];
    const std::size_t end = i + 1 < scan.parts.size() ? scan.parts[i + 1].begin : scan.size();
    const std::string numbers =
        formatted(",%.9f,%zu,%zu\n", scan.stamp + part.stamp, part.begin, end - part.begin);
    rows += std::to_string(frame.index) + "," + csvField(part.sensor_label) + numbers;
  }
  return rows;
}

std::vector<ScanPartRow> readScanParts(const std::string& path)
{
  CsvTable file(path);
  const std::size_t frame = file.column("frame");
  const std::size_t label = file.column("sensor_label");
  const std::size_t stamp = file.column("stamp");
  const std::size_t points = file.column("points");
  std::vector<ScanPartRow> rows;
  while (file.next())
  {
    rows.push_back(
        {file.count(frame), std::string(file.text(label)), file.number(stamp), file.count(points)});
  }
  return rows;
}
}  // namespace dyslam
