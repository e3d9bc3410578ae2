// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/KittiConverter.h>

#include <map>
#include <string>

#include "../common/AppMain.h"
#include "../common/Checks.h"
#include "../common/ConversionFlags.h"
#include "../common/ConversionReport.h"
#include "../common/OutputOptions.h"

namespace
{
using namespace dyslam;

struct Arguments
{
  std::string input;
  std::string output;
  KittiConverterOptions options;
  bool force = false;
  bool quiet = false;
};

const std::map<std::string, KittiKind> kinds{{"odometry", KittiKind::odometry},
                                             {"raw", KittiKind::raw},
                                             {"tracking", KittiKind::tracking},
                                             {"360", KittiKind::kitti360}};
const std::map<std::string, PoseFrame> pose_frames{
    {"auto", PoseFrame::automatic}, {"lidar", PoseFrame::lidar}, {"camera", PoseFrame::camera}};

void declare(CLI::App& app, Arguments& arguments)
{
  KittiConverterOptions& o = arguments.options;
  app.description("Converts a KITTI recording to an MRPT rawlog with its ground truth beside it");
  app.add_option("--kind", o.kind, "odometry, raw, tracking or 360 (KITTI-360)")
      ->required()
      ->transform(wordFor(kinds));
  app.add_option("-i,--input", arguments.input, "folder of the recording")->required();
  addOutputFile(app, "-o,--output", arguments.output, "rawlog to write")->required();
  app.add_option("--calib", o.calib,
                 "calib.txt, folder with calib_cam_to_cam.txt, calib_velo_to_cam.txt and "
                 "calib_imu_to_velo.txt, or calibration of KITTI-360");
  app.add_option("--poses", o.poses,
                 "true poses, TUM or KITTI, or poses.txt or cam0_to_world.txt of KITTI-360");
  app.add_option("--pose-frame", o.pose_frame, "frame of these poses: auto, lidar or camera")
      ->transform(wordFor(pose_frames));
  declarePoseSource(app, o.pose_source, "where the true poses are from");
  declareDeskewed(app, o.deskewed);
  app.add_option("--oxts", o.oxts, "GNSS/INS file or folder: truth where there are no poses");
  app.add_flag("--imu", o.imu,
               "with the angular velocities and accelerations of oxts, beside the scans");
  app.add_flag("--gnss", o.gnss, "with the positions of oxts, beside the scans");
  app.add_option("--labels", o.labels, "folder of .label files, one label per point");
  app.add_option("--boxes", o.boxes, "label_02 file, or folder of SUSTechPOINTS json");
  app.add_option("--sequence", o.sequence,
                 "sequence of tracking's official layout or drive of KITTI-360, such as 0000");
  app.add_flag("--no-truth", o.no_truth, "scans only: no poses, labels or boxes");
  app.add_option("--times", o.times,
                 "times, a line for each frame number: seconds, or KITTI's timestamps.txt");
  declareSensorPose(app, o.sensor_pose);
  app.add_option("--dt", o.dt, "seconds between scans; default: the layout's times, else 0.1034")
      ->check(positive());
  declareVerticalAngles(app, o.vertical_angle_correction);
  declareRawlog(app, o);
  app.add_flag("--force", arguments.force, "replace an earlier recording and its ground truth");
  app.add_flag("-q,--quiet", arguments.quiet, "no progress");
}

void run(const Arguments& arguments)
{
  const KittiKind kind = arguments.options.kind;
  if (!arguments.options.sequence.empty() && kind != KittiKind::tracking &&
      kind != KittiKind::kitti360)
  {
    throw UserError(
        "--sequence goes with --kind tracking or 360; another recording is its folder, -i");
  }
  runConversion(
      "kitti2rawlog", arguments.input, arguments.output, arguments.force, arguments.quiet,
      [&](const ConversionProgress& progress)
      { return convertKitti(arguments.input, arguments.output, arguments.options, progress); });
}
}  // namespace

int main(int argc, char** argv)
{
  Arguments arguments;
  return dyslam::runApp(
      argc, argv, [&](CLI::App& app) { declare(app, arguments); }, [&] { run(arguments); });
}
