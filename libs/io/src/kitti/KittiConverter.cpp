// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/PointTimeFiles.h>
#include <dyslam/formats/ScanFiles.h>
#include <dyslam/io/KittiConverter.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "KittiLayout.h"
#include "conversion/ConversionOutput.h"
#include "conversion/MotionSampleWriter.h"

namespace dyslam
{
namespace
{
/** KITTI odometry's scans were unwrapped with vertical angles 0.205 degrees too low. */
constexpr float vertical_angle_error = 0.205F * static_cast<float>(M_PI) / 180.0F;

/** Turns each point up about the horizontal axis square to its direction. */
void correctVerticalAngles(Scan& scan)
{
  for (Eigen::Vector3f& point : scan.points)
  {
    const Eigen::Vector3f axis(point.y(), -point.x(), 0);
    const float length = axis.norm();
    if (point.allFinite() && length > 0)
    {
      point = Eigen::AngleAxisf(vertical_angle_error, axis / length) * point;
    }
  }
}

/** The scans to convert. \throws UserError if there are none. */
std::vector<const KittiLayout::Entry*> usedEntries(const std::string& input,
                                                   const KittiLayout& layout,
                                                   const KittiConverterOptions& options)
{
  std::vector<const KittiLayout::Entry*> used;
  ScanSelection selection(options, options.every_n);
  const auto most = static_cast<std::size_t>(options.only_first_n);
  for (std::size_t i = 0; i < layout.entries.size() && (most == 0 || used.size() < most); ++i)
  {
    if (selection.takes(i, layout.entries[i].stamp))
    {
      used.push_back(&layout.entries[i]);
    }
  }
  if (used.empty())
  {
    throw UserError(input + ": has " + counted(layout.entries.size(), "scan") + "; " +
                    emptyRange(options));
  }
  return used;
}

/** \throws UserError for scans with other columns than KITTI's. */
void requireKittiColumns(const std::string& scan)
{
  if (binLayoutOf(scan) != kitti_layout)
  {
    throw UserError(scan + ": has 5 numbers per point (x y z intensity ring), KITTI's have 4; " +
                    "convert the folder of the scans with scans2rawlog");
  }
}

/** What was converted, and what its user should know. */
void addNotes(const KittiLayout& layout,
              const KittiConverterOptions& options,
              bool deskewed,
              const MotionSampleWriter& motion,
              ConversionResult& result)
{
  result.notes.insert(result.notes.end(), layout.notes.begin(), layout.notes.end());
  result.notes.emplace_back(
      deskewed ? "the scans count as deskewed, as KITTI odometry's are; if yours are not: "
                 "--deskewed no"
      : layout.has_point_times
          ? "the points have the times of " + std::string(point_time_folder) +
                ": the scans are as they were recorded, and dyslam deskews them"
          : "the points have no times: dyslam deskews by their order, by azimuth or not at all "
            "(preprocess.deskew)");
  if (options.every_n > 1 && !deskewed && !layout.has_point_times)
  {
    result.warnings.emplace_back(thinned_without_times);
  }
  if (layout.has_unused_oxts)
  {
    result.notes.emplace_back(
        "oxts has an IMU and positions: kitti2rawlog --imu and --gnss convert them, too");
  }
  if (layout.pose_origin.source == PoseSource::gnss_ins)
  {
    result.notes.push_back("the true poses are from GNSS/INS (" + layout.pose_origin.name +
                           "), which is off by centimetres from scan to scan; --poses FILE of "
                           "kitti2rawlog for better ones, --no-truth for none");
  }
  if (options.imu)
  {
    result.notes.push_back("IMU: " + counted(motion.imu().samples, "sample") + " of oxts");
  }
  if (options.gnss)
  {
    result.notes.push_back("satellite receiver: " + counted(motion.gnss().samples, "position") +
                           " of oxts");
  }
}

/** \param deskewed all points are of one instant */
Scan readKittiScan(const KittiLayout::Entry& entry,
                   const Pose& T_vehicle_lidar,
                   bool correct_angles,
                   bool deskewed)
{
  Scan scan = readBin(entry.scan);
  scan.stamp = entry.stamp;
  scan.sensor_label = "velodyne";
  scan.T_vehicle_lidar = T_vehicle_lidar;
  if (correct_angles)
  {
    correctVerticalAngles(scan);
  }
  if (deskewed)
  {
    scan.time.assign(scan.size(), 0.F);
  }
  else if (!entry.times.empty())
  {
    scan.time = readPointTimes(entry.times, scan.size());
  }
  return scan;
}
}  // namespace

void KittiConverterOptions::describe(OptionsVisitor& visitor)
{
  visitor.choice("kind", kind,
                 {{"odometry", KittiKind::odometry},
                  {"raw", KittiKind::raw},
                  {"tracking", KittiKind::tracking},
                  {"360", KittiKind::kitti360}},
                 "kind of KITTI's folder layouts");
  visitor.text("calib", calib, "calibration file or folder; empty: as in the layout");
  visitor.text("poses", poses, "file of TUM, KITTI or KITTI-360 poses; empty: as in the layout");
  visitor.text("oxts", oxts, "GNSS/INS file or folder, used where there are no poses");
  visitor.text("labels", labels, "folder of .label files of the scans");
  visitor.text("boxes", boxes, "boxes of objects: label_02 file, or folder of SUSTechPOINTS json");
  visitor.text("sequence", sequence,
               "sequence of tracking's official layout or drive of KITTI-360, such as 0000");
  visitor.text("times", times, "file of times, a line for each frame number");
  visitor.text("sensor_pose", sensor_pose,
               "pose of the lidar on the vehicle, x y z yaw pitch roll; empty: identity [m, deg]");
  visitor.flag("imu", imu, "convert the angular velocities and accelerations of oxts, too");
  visitor.flag("gnss", gnss, "convert the positions of oxts, too");
  visitor.flag("no_truth", no_truth, "convert scans only: no poses, labels or boxes");
  visitor.choice(
      "pose_frame", pose_frame,
      {{"auto", PoseFrame::automatic}, {"lidar", PoseFrame::lidar}, {"camera", PoseFrame::camera}},
      "frame of the poses in the pose file");
  visitor.choice(
      "deskewed", deskewed,
      {{"auto", ScansDeskewed::automatic}, {"yes", ScansDeskewed::yes}, {"no", ScansDeskewed::no}},
      "scans are deskewed already; auto: yes for KITTI odometry");
  visitor.real("dt", dt, 0, 3600, "time between scans; 0: the layout's times, else 0.1034 [s]");
  visitor.flag("vertical_angle_correction", vertical_angle_correction,
               "correct the elevation of points by +0.205 deg");
  describePoseSource(visitor, "pose_source", pose_source,
                     "source of the true poses; unknown: by the files that they are from");
  describeConversion(visitor);
}

ConversionResult convertKitti(const std::string& input,
                              const std::string& output,
                              const KittiConverterOptions& options,
                              const ConversionProgress& progress)
{
  validate(options, "kitti2rawlog");
  requireNoInput(output, {input, options.calib, options.poses, options.oxts, options.labels,
                          options.boxes, options.times});
  const Pose T_vehicle_lidar = poseFromOption("--sensor-pose", options.sensor_pose);
  const KittiLayout layout = readKittiLayout(input, options);
  requireKittiColumns(layout.entries.front().scan);
  std::multimap<int, const LabelledBox*> boxes;
  for (const LabelledBox& box : layout.boxes)
  {
    boxes.emplace(box.frame, &box);
  }
  const std::vector<const KittiLayout::Entry*> entries = usedEntries(input, layout, options);
  const bool deskewed = options.deskewed == ScansDeskewed::yes ||
                        (options.deskewed == ScansDeskewed::automatic &&
                         options.kind == KittiKind::odometry && !layout.has_point_times);
  ConversionOutput out(output, options, layout.pose_origin);
  MotionSampleWriter motion;
  auto imu = layout.imu.begin();
  auto fix = layout.gnss.begin();
  ConversionResult result = out.fill(
      [&]
      {
        for (std::size_t i = 0; i < entries.size(); ++i)
        {
          const KittiLayout::Entry& entry = *entries[i];
          const Scan scan =
              readKittiScan(entry, T_vehicle_lidar, options.vertical_angle_correction, deskewed);
          for (; imu != layout.imu.end() && imu->stamp <= scan.stamp; ++imu)
          {
            motion.add(*imu);
          }
          for (; fix != layout.gnss.end() && fix->stamp <= scan.stamp; ++fix)
          {
            motion.add(*fix);
          }
          motion.writeUpTo(scan.stamp, out);
          out.write(scan, entry.T_world_lidar);
          if (!entry.labels.empty())
          {
            out.addLabels(readLabels(entry.labels, scan.size()));
          }
          const auto range = boxes.equal_range(static_cast<int>(entry.number));
          std::for_each(range.first, range.second,
                        [&out](const auto& box) { out.addBox(*box.second); });
          out.reportProgress(progress,
                             static_cast<double>(i + 1) / static_cast<double>(entries.size()));
        }
        return out.close();
      });
  result.warnings = layout.warnings;
  addNotes(layout, options, deskewed, motion, result);
  result.pose_source = layout.pose_file;
  return result;
}
}  // namespace dyslam
