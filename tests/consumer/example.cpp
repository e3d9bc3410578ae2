// SPDX-License-Identifier: BSD-3-Clause
// Registers two synthetic scans through the installed library; exit code 0 if the motion is found.
#include <dyslam/formats/TrajectoryFiles.h>
#include <dyslam/odometry/LocalMapRegistration.h>

#include <cmath>
#include <cstdio>

namespace
{
/** Points on the ground and two walls, in the vehicle frame. */
dyslam::Frame frameAt(const dyslam::Pose& T_world_vehicle)
{
  dyslam::Frame frame;
  const Eigen::Isometry3f T = T_world_vehicle.inverse().cast<float>();
  for (int i = -40; i <= 40; ++i)
  {
    for (int j = -40; j <= 40; ++j)
    {
      const float a = 0.37F * static_cast<float>(i);
      const float b = 0.41F * static_cast<float>(j);
      frame.cloud.points.push_back(T * Eigen::Vector3f(a, b, -1.7F));
      frame.cloud.points.push_back(T * Eigen::Vector3f(a, 12, 0.1F * b));
      frame.cloud.points.push_back(T * Eigen::Vector3f(15, a, 0.1F * b));
    }
  }
  return frame;
}
}  // namespace

int main()
{
  dyslam::ThreadPool pool(1);
  dyslam::LocalMapRegistration registration(dyslam::RefineOptions(), pool);
  const dyslam::Frame first = frameAt(dyslam::Pose::Identity());
  registration.commit(registration.align(first, dyslam::Pose::Identity()), first);
  const auto truth = dyslam::poseFromYpr(0.3, 0.1, 0, 0.01, 0, 0);
  const dyslam::RegistrationResult result =
      registration.align(frameAt(truth), dyslam::Pose::Identity()).result();
  dyslam::Trajectory trajectory;
  trajectory.push_back(0, result.T_odom_vehicle);
  dyslam::writeTum("consumer_tum.txt", trajectory);
  const double error = (truth.inverse() * result.T_odom_vehicle).translation().norm();
  std::printf("error %.4f m\n", error);
  return error < 0.05 ? 0 : 1;
}
