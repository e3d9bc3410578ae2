// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/benchmarks/DetectionDeskew.h>
#include <dyslam/benchmarks/KittiSlam.h>
#include <dyslam/benchmarks/KittiTracking.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/KittiTracks.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <memory>
#include <random>

namespace dyslam
{
namespace
{
/** Scale of the visual odometry: the distance by OXTS along its steps, divided by their length. */
double scaleOf(const std::vector<Pose>& visual, const std::vector<Pose>& measured)
{
  double products = 0;
  double squares = 0;
  constexpr std::size_t block = 10;
  for (std::size_t i = 0; i + block < measured.size(); i += block)
  {
    const double a = (visual[i].inverse() * visual[i + block]).translation().norm();
    const double b = (measured[i].inverse() * measured[i + block]).translation().norm();
    products += a * b;
    squares += a * a;
  }
  return squares > 0 ? products / squares : 1;
}

/** Poses of the lidar from all data but objects: OXTS, whose positions drift by up to a metre and
 * jitter by a tenth, and the visual odometry, which is smooth up to its scale. */
std::vector<Pose> fusedTruth(const std::vector<Pose>& oxts, const std::vector<Pose>& visual)
{
  constexpr double position_sigma = 10;  // large, since readings have correlated errors [m]
  constexpr double angle_sigma = 0.05;   // sigma of a reading's orientation [rad]
  const Matrix6 absolute = informationFromSigmas(position_sigma, angle_sigma);
  const Matrix6 relative = informationFromSigmas(0.01, 0.0005);
  const double scale = scaleOf(visual, oxts);
  FactorGraph graph;
  const std::size_t world = oxts.size();
  graph.addPose(Key::ego(world), Pose::Identity());
  graph.setFixed(Key::ego(world), true);
  for (std::size_t i = 0; i < oxts.size(); ++i)
  {
    graph.addPose(Key::ego(i), oxts[i]);
    graph.add(std::make_unique<LoopFactor>(world, i, oxts[i], absolute));
    if (i > 0)
    {
      Pose step = visual[i - 1].inverse() * visual[i];
      step.translation() *= scale;
      graph.add(std::make_unique<OdometryFactor>(i - 1, i, step, relative));
    }
  }
  FactorGraphOptions plain;
  plain.loop_loss = RobustLoss::none;
  (void)graph.optimise(plain);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < oxts.size(); ++i)
  {
    poses.push_back(graph.pose(Key::ego(i)));
  }
  return poses;
}
}  // namespace

KittiDrive readKittiDrive(const std::string& folder,
                          const std::string& name,
                          const std::string& detector,
                          double min_score,
                          const DetectionNoiseOptions& noise)
{
  const std::string file = name + ".txt";
  const KittiCalib calib = readKittiCalib(folder + "/calib/" + file);
  const std::vector<OxtsReading> readings = readOxts(folder + "/oxts/" + file);
  if (readings.empty())
  {
    throw UserError(folder + "/oxts/" + file + ": has no readings");
  }
  KittiDrive drive;
  drive.name = name;
  const Pose T_velo_cam = calib.T_cam_velo.inverse();
  const Trajectory camera = readTrajectory(folder + "/orbslam3_cam0/" + file).trajectory;
  for (std::size_t i = 0; i < camera.size(); ++i)
  {
    drive.visual.push_back(T_velo_cam * camera[i].pose * calib.T_cam_velo);
  }
  if (drive.visual.size() != readings.size())
  {
    throw UserError(folder + "/orbslam3_cam0/" + file + ": has " +
                    counted(drive.visual.size(), "pose") + " for " +
                    counted(readings.size(), "reading") + " of oxts");
  }
  drive.truth = fusedTruth(posesOfMountedSensor(oxtsPoses(readings), calib.T_velo_imu.inverse()),
                           drive.visual);
  drive.detections.resize(drive.truth.size());
  for (std::size_t i = 0; i < drive.truth.size(); ++i)
  {
    drive.stamps.push_back(static_cast<double>(i) * kitti_scan_period);
  }
  drive.labels = readKittiTracking(folder + "/label_02/" + file, calib.T_cam_velo);
  const std::vector<LabelledBox> boxes =
      detector == "labels"
          ? drive.labels
          : readDetections(folder + "/det_" + detector + "/Car/" + file, calib.T_cam_velo);
  for (const LabelledBox& box : boxes)
  {
    if (box.frame >= 0 && static_cast<std::size_t>(box.frame) < drive.truth.size() &&
        (detector == "labels" || box.score >= min_score))
    {
      Detection detection;
      detection.box = box.box;
      detection.object_class = box.object_class;
      detection.score = box.score;
      detection.covariance = detectionCovariance(box.box, box.object_class, noise);
      drive.detections[static_cast<std::size_t>(box.frame)].push_back(detection);
    }
  }
  return drive;
}

std::vector<Pose> noisyOdometry(const std::vector<Pose>& truth,
                                const OdometryNoise& noise,
                                std::uint32_t seed)
{
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<Pose> odometry{Pose::Identity()};
  for (std::size_t i = 1; i < truth.size(); ++i)
  {
    const Pose step = truth[i - 1].inverse() * truth[i];
    const double sigma = noise.per_step + noise.per_metre * step.translation().norm();
    Vector6 error;
    for (Eigen::Index k = 0; k < 6; ++k)
    {
      error[k] = normal(generator) * (k < 3 ? sigma : noise.turn);
    }
    odometry.push_back(orthonormalised(odometry.back() * step * expSE3(error)));
  }
  return odometry;
}

std::vector<Matrix6> stepInformation(const std::vector<Pose>& odometry, const OdometryNoise& noise)
{
  std::vector<Matrix6> result{Matrix6::Identity()};
  for (std::size_t i = 1; i < odometry.size(); ++i)
  {
    const double length = (odometry[i].translation() - odometry[i - 1].translation()).norm();
    result.push_back(informationFromSigmas(noise.per_step + noise.per_metre * length, noise.turn));
  }
  return result;
}

KittiSlamRun runKittiSlam(const KittiDrive& drive,
                          const std::vector<Pose>& odometry,
                          const std::vector<Matrix6>& step_information,
                          const TrackerOptions& tracker_options,
                          const BackendConfig& config)
{
  Tracker tracker(tracker_options);
  KeyframeStore keyframes;
  Backend backend(config, keyframes);
  KittiSlamRun run;
  for (std::size_t i = 0; i < drive.truth.size(); ++i)
  {
    Frame frame;
    frame.index = i;
    frame.scan.stamp = drive.stamps[i];
    frame.T_odom_vehicle = odometry[i];
    if (i > 0)
    {
      frame.motion.T_previous_current = odometry[i - 1].inverse() * odometry[i];
      frame.motion.information = step_information[i];
    }
    frame.motion.status = MotionStatus::converged;
    frame.detections = drive.detections[i];
    deskewDetections(frame.detections, frame.motion.T_previous_current, kitti_scan_period,
                     kitti_scan_period);
    tracker.update(frame);
    backend.addOdometry(frame);
    backend.optimise(frame);
    run.tracked.push_back(frame.objects);
  }
  backend.finish();
  const Trajectory trajectory = backend.optimisedTrajectory();
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    run.trajectory.push_back(trajectory[i].pose);
  }
  run.objects = backend.smoothedObjects();
  run.warnings = backend.warnings();
  return run;
}
}  // namespace dyslam
