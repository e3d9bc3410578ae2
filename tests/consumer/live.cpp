// SPDX-License-Identifier: BSD-3-Clause
// SLAM on scans as a live driver delivers them: one Frame per scan goes through the pipeline, which
// fills in pose, moving points and objects. Here the scans are of a vehicle that drives through a
// simulated hall; exit code 0 if its path is found.
#include <dyslam/base/Error.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/pipeline/Pipeline.h>
#include <dyslam/pipeline/StartSpeed.h>
#include <dyslam/run/GivenSettings.h>
#include <mrpt/system/CTimeLogger.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace
{
constexpr double period = 0.1;  // scan period of the sensor [s]

/** Distance along a ray to the floor, the walls and four pillars of a hall of 60 x 24 m. */
double rangeAlong(const Eigen::Vector3d& from, const Eigen::Vector3d& ray)
{
  double range = ray.z() < 0 ? -from.z() / ray.z() : 1e3;
  const Eigen::Vector2d half(30, 12);
  for (int axis = 0; axis < 2; ++axis)
  {
    const double wall = ray[axis] > 0 ? half[axis] : -half[axis];
    range = std::abs(ray[axis]) > 1e-9 ? std::min(range, (wall - from[axis]) / ray[axis]) : range;
  }
  for (const Eigen::Vector2d& pillar : {Eigen::Vector2d(-10, 5), Eigen::Vector2d(4, -6),
                                        Eigen::Vector2d(13, 6), Eigen::Vector2d(20, -4)})
  {
    const Eigen::Vector2d to = pillar - from.head<2>();
    const double flat = ray.head<2>().norm();
    const double along = to.dot(ray.head<2>()) / flat;
    const double across2 = to.squaredNorm() - along * along;
    constexpr double radius = 0.5;
    if (along > 0 && across2 < radius * radius)
    {
      range = std::min(range, (along - std::sqrt(radius * radius - across2)) / flat);
    }
  }
  return range;
}

/** A scan as a driver delivers it: points in the lidar frame [m], time stamp [s] and mounting of
 * the lidar. Intensities, rings and times of the points are filled in if they are known. */
dyslam::Scan scanAt(const dyslam::Pose& T_world_vehicle, double stamp)
{
  dyslam::Scan scan;
  scan.stamp = stamp;
  scan.T_vehicle_lidar.translation() = Eigen::Vector3d(0, 0, 1.8);
  const dyslam::Pose T_world_lidar = T_world_vehicle * scan.T_vehicle_lidar;
  for (int ring = 0; ring < 32; ++ring)
  {
    const double elevation = (-25.0 + ring) * M_PI / 180;
    for (int column = 0; column < 900; ++column)
    {
      const double azimuth = 2 * M_PI * column / 900;
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      const double range = rangeAlong(T_world_lidar.translation(), T_world_lidar.linear() * ray);
      scan.points.push_back((range * ray).cast<float>());
      scan.ring.push_back(static_cast<std::uint16_t>(ring));
    }
  }
  return scan;
}

/** T_world_vehicle of a vehicle that drives in a curve, at 3 m/s. */
dyslam::Pose poseAt(std::size_t scan)
{
  dyslam::Pose T_world_vehicle = dyslam::Pose::Identity();
  for (std::size_t i = 0; i < scan; ++i)
  {
    T_world_vehicle = T_world_vehicle * dyslam::poseFromYpr(0.3, 0, 0, 0.01, 0, 0);
  }
  return T_world_vehicle;
}

/** The next frame; a real program would ask the driver here. */
dyslam::Frame frameAt(std::size_t scan)
{
  dyslam::Frame frame;
  frame.index = scan;
  frame.scan = scanAt(poseAt(scan), 1e9 + period * static_cast<double>(scan));
  return frame;
}

/** The settings with which dyslam would run: the shipped settings that fit the sensor, single
 * values that override them, the rotation that levels a lidar whose tilt is not known and, if the
 * first scans do not determine it, the speed at which they begin. */
dyslam::ChosenSettings settingsFrom(std::vector<dyslam::Frame>& first)
{
  const dyslam::GivenSettings given = dyslam::readGivenSettings(
      "", {"labels.hindsight=false",    // later scans are not available
           "preprocess.deskew=none"});  // all points of these scans are measured at one moment
  const dyslam::RecordedSensor sensor = dyslam::recogniseSensor(first);
  dyslam::ChosenSettings chosen = dyslam::settingsFor(sensor, given);
  std::printf("%s; settings: %s\n", sensor.summary().c_str(), chosen.source.c_str());
  if (!chosen.levelling_note.empty())
  {
    std::printf("note: %s\n", chosen.levelling_note.c_str());
  }
  for (const std::string& warning : chosen.warnings)
  {
    std::printf("warning: %s\n", warning.c_str());
  }
  for (dyslam::Frame& frame : first)
  {
    chosen.level(frame);
  }
  if (const auto speed = dyslam::findStartSpeed(first, chosen.config))
  {
    dyslam::setStartSpeed(*speed, chosen.config);
  }
  return chosen;
}

/** Results that a program would publish: the vehicle and the objects in the odometry frame, and the
 * pose of that frame in the map. \param levelling converts poses of the levelled vehicle to poses
 * of the vehicle itself */
void publish(const dyslam::Frame& frame, const dyslam::Levelling& levelling)
{
  const auto reported =
      std::count_if(frame.objects.begin(), frame.objects.end(),
                    [](const dyslam::TrackedObject& object) { return object.reported; });
  const dyslam::Pose T_odom_vehicle = levelling.recorded(frame.T_odom_vehicle);
  const Eigen::Vector3d in_odom = T_odom_vehicle.translation();
  const Eigen::Vector3d in_map = (frame.T_map_odom * T_odom_vehicle).translation();
  std::printf("scan %zu: at %.2f %.2f m (map: %.2f %.2f m), %zu points, %td objects%s\n",
              frame.index, in_odom.x(), in_odom.y(), in_map.x(), in_map.y(), frame.cloud.size(),
              reported, frame.is_keyframe ? ", keyframe" : "");
}

/** Writes the static map to a file, unless mapping is off. */
void saveMap(const dyslam::Pipeline& slam, const std::string& path)
{
  if (const dyslam::StaticMap* map = slam.map())
  {
    dyslam::writeMapCloud(map->points(), path);
  }
}

int run()
{
  constexpr std::size_t count = 30;
  constexpr std::size_t waited_for = 10;  // number of scans that choose the settings
  std::vector<dyslam::Frame> frames;
  for (std::size_t i = 0; i < waited_for; ++i)
  {
    frames.push_back(frameAt(i));
  }
  const dyslam::ChosenSettings settings = settingsFrom(frames);
  dyslam::ConfigLoader loader(settings.config);
  mrpt::system::CTimeLogger times(false);
  dyslam::Pipeline slam(loader, times);

  dyslam::Frame frame;
  for (std::size_t i = 0; i < count; ++i)
  {
    if (i < waited_for)
    {
      frame = frames[i];
    }
    else
    {
      frame = frameAt(i);
      settings.level(frame);
    }
    slam.process(frame);
    publish(frame, settings.levelling);
  }
  slam.finish();
  saveMap(slam, "live_map.pcd");
  const dyslam::Pose T_map_vehicle = settings.levelling.recorded(frame.T_map_vehicle());
  const double error = (poseAt(count - 1).inverse() * T_map_vehicle).translation().norm();
  std::printf("error after 8.7 m: %.3f m\n", error);
  return error < 0.1 ? 0 : 1;
}
}  // namespace

int main()
{
  try
  {
    return run();
  }
  catch (const dyslam::UserError& error)  // a bad setting, or a missing file
  {
    std::fprintf(stderr, "live: %s\n", error.what());
    return 1;
  }
}
