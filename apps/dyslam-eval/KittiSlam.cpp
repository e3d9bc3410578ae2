// SPDX-License-Identifier: BSD-3-Clause
#include "KittiSlam.h"

#include <dyslam/backend/factors/LoopFactor.h>
#include <dyslam/backend/factors/OdometryFactor.h>
#include <dyslam/core/Error.h>
#include <dyslam/formats/KittiFiles.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <filesystem>
#include <memory>
#include <random>

namespace dyslam
{
namespace
{
constexpr double frame_time = 0.1;  // between scans [s]

/** Poses of the IMU from OXTS. Its positions slide by up to a metre and jitter by a tenth, its
 * velocities and angles are smooth: the positions are taken as weak absolute measurements. */
std::vector<Pose> smoothedOxts(const std::vector<OxtsReading>& readings)
{
  constexpr double position_sigma = 1;        // [m]
  constexpr double velocity_sigma = 0.03;     // [m/s]
  constexpr double angle_sigma = 0.0002;      // per step [rad]
  const std::vector<Pose> measured = oxtsPoses(readings);
  FactorGraph graph;
  const std::size_t world = readings.size();
  graph.addPose(Key::ego(world), Pose::Identity());
  graph.setFixed(Key::ego(world), true);
  const auto velocityOf = [](const OxtsReading& r)
  { return Eigen::Vector3d(r.velocity_forward, r.velocity_left, r.velocity_up); };
  for (std::size_t i = 0; i < readings.size(); ++i)
  {
    graph.addPose(Key::ego(i), measured[i]);
    graph.add(std::make_unique<LoopFactor>(world, i, measured[i],
                                           informationFromSigmas(position_sigma, 0.01)));
    if (i > 0)
    {
      Pose step = measured[i - 1].inverse() * measured[i];
      const Eigen::Vector3d v0 = velocityOf(readings[i - 1]);
      const Eigen::Vector3d v1 = step.linear() * velocityOf(readings[i]);
      step.translation() = 0.5 * frame_time * (v0 + v1);
      graph.add(std::make_unique<OdometryFactor>(
          i - 1, i, step, informationFromSigmas(velocity_sigma * frame_time, angle_sigma)));
    }
  }
  FactorGraphOptions plain;
  plain.loop_loss = RobustLoss::none;
  (void)graph.optimise(plain);
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < readings.size(); ++i)
  {
    poses.push_back(graph.pose(Key::ego(i)));
  }
  return poses;
}

Detection detectionOf(const LabelledBox& box)
{
  Detection detection;
  detection.box = box.box;
  detection.object_class = box.object_class;
  detection.score = box.score;
  const double range = box.box.center.head<2>().norm();
  const Eigen::Vector2d direction = box.box.center.head<2>() / std::max(range, 1e-6);
  const Eigen::Vector2d across(-direction.y(), direction.x());
  const double radial = 0.08 + 0.005 * range;
  const double tangential = 0.05 + 0.0015 * range;
  const double yaw = (2 + 0.08 * range) * M_PI / 180;
  detection.covariance.setZero();
  detection.covariance.topLeftCorner<2, 2>() =
      radial * radial * direction * direction.transpose() +
      tangential * tangential * across * across.transpose();
  detection.covariance(2, 2) = 0.01;
  detection.covariance(3, 3) = yaw * yaw;
  return detection;
}

/** Moves boxes of a sweep that is not deskewed to the stamp of the scan. */
void deskew(std::vector<Detection>& detections, const Pose& motion)
{
  const Vector6 twist = logSE3(motion);
  for (Detection& detection : detections)
  {
    const double phase =
        -std::atan2(detection.box.center.y(), detection.box.center.x()) / (2 * M_PI);
    const Pose T = expSE3(phase * twist);
    detection.box.center = T * detection.box.center;
    detection.box.yaw += yawPitchRoll(T).x();
  }
}
}  // namespace

KittiDrive readKittiDrive(const std::string& folder,
                          const std::string& name,
                          const std::string& detector,
                          double min_score)
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
  drive.truth = imuToLidarPoses(smoothedOxts(readings), calib.T_velo_imu);
  drive.detections.resize(drive.truth.size());
  for (std::size_t i = 0; i < drive.truth.size(); ++i)
  {
    drive.stamps.push_back(static_cast<double>(i) * frame_time);
  }
  drive.labels = readKittiTracking(folder + "/label_02/" + file, calib.T_cam_velo);
  const std::vector<LabelledBox> boxes =
      detector == "labels"
          ? drive.labels
          : readDetectionsCsv(folder + "/det_" + detector + "/Car/" + file, calib.T_cam_velo);
  for (const LabelledBox& box : boxes)
  {
    if (box.frame >= 0 && static_cast<std::size_t>(box.frame) < drive.truth.size() &&
        (detector == "labels" || box.score >= min_score))
    {
      drive.detections[static_cast<std::size_t>(box.frame)].push_back(detectionOf(box));
    }
  }
  const std::string visual = folder + "/orbslam3_cam0/" + file;
  if (std::filesystem::exists(visual))
  {
    const Pose T_velo_cam = calib.T_cam_velo.inverse();
    const Trajectory camera = readTrajectory(visual).trajectory;
    for (std::size_t i = 0; i < camera.size(); ++i)
    {
      drive.visual.push_back(T_velo_cam * camera[i].pose * calib.T_cam_velo);
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
    odometry.push_back(orthonormalized(odometry.back() * step * expSE3(error)));
  }
  return odometry;
}

std::vector<Matrix6> stepInformation(const std::vector<Pose>& odometry, const OdometryNoise& noise)
{
  std::vector<Matrix6> result{Matrix6::Identity()};
  for (std::size_t i = 1; i < odometry.size(); ++i)
  {
    const double length = (odometry[i].translation() - odometry[i - 1].translation()).norm();
    result.push_back(
        informationFromSigmas(noise.per_step + noise.per_metre * length, noise.turn));
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
    frame.motion.converged = true;
    frame.detections = drive.detections[i];
    deskew(frame.detections, frame.motion.T_previous_current);
    tracker.update(frame);
    backend.addOdometry(frame);
    backend.optimise(frame);
    run.tracked.push_back(frame.objects);
  }
  backend.finish();
  const Trajectory trajectory = backend.optimizedTrajectory();
  for (std::size_t i = 0; i < trajectory.size(); ++i)
  {
    run.trajectory.push_back(trajectory[i].pose);
  }
  run.objects = backend.smoothedObjects();
  run.warnings = backend.warnings();
  return run;
}
}  // namespace dyslam
