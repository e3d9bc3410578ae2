// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/DetectionDeskew.h>

#include <cmath>
#include <map>

#include "KittiSlam.h"

namespace dyslam
{
namespace
{
constexpr int half_window = 5;      // scans beside one whose true speed is estimated
constexpr double slowest = 1;       // of the vehicles that are judged [m/s]
constexpr double max_distance = 2;  // of an observation from its label [m]

using Track = std::map<int, Eigen::Vector2d>;  // positions in the plane by scan

bool isVehicle(ObjectClass object_class)
{
  return object_class == ObjectClass::car || object_class == ObjectClass::van ||
         object_class == ObjectClass::truck;
}

/** Labels in the world; their scans are not deskewed either. */
std::map<int, Track> labelledTracks(const KittiDrive& drive)
{
  std::map<int, Track> tracks;
  for (const LabelledBox& label : drive.labels)
  {
    const auto scan = static_cast<std::size_t>(label.frame);
    if (label.frame < 1 || scan >= drive.truth.size() || !isVehicle(label.object_class))
    {
      continue;
    }
    const double interval = drive.stamps[scan] - drive.stamps[scan - 1];
    const Box box = deskewed(label.box, drive.truth[scan - 1].inverse() * drive.truth[scan],
                             interval, {interval, true});
    tracks[label.id][label.frame] = (drive.truth[scan] * box.center).head<2>();
  }
  return tracks;
}

/** Slope of the line through the labels around a scan; false where some are missing. */
bool trueSpeed(const Track& track, int scan, const std::vector<double>& stamps, double& speed)
{
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double spread = 0;
  for (int k = -half_window; k <= half_window; ++k)
  {
    const auto at = track.find(scan + k);
    if (at == track.end())
    {
      return false;
    }
    const double t =
        stamps[static_cast<std::size_t>(scan + k)] - stamps[static_cast<std::size_t>(scan)];
    moment += t * at->second;
    spread += t * t;
  }
  speed = (moment / spread).norm();
  return true;
}

const SmoothedObject* smoothedAt(const KittiSlamRun& run, std::size_t scan, int id)
{
  for (const SmoothedObject& object : run.objects)
  {
    if (object.scan == scan && object.id == id)
    {
      return &object;
    }
  }
  return nullptr;
}

/** The observed track nearest to a place; null if none is near. \param T_world_odom at the scan */
const TrackedObject* nearest(const std::vector<TrackedObject>& tracked,
                             const Pose& T_world_odom,
                             const Eigen::Vector2d& place)
{
  const TrackedObject* best = nullptr;
  double smallest = max_distance;
  for (const TrackedObject& object : tracked)
  {
    const double distance = ((T_world_odom * object.observation.center).head<2>() - place).norm();
    if (object.observed && distance < smallest)
    {
      smallest = distance;
      best = &object;
    }
  }
  return best;
}

/** Sums of squares to root mean squares. */
void takeRoots(KittiObjectErrors& e)
{
  for (double* sum : {&e.observed_position, &e.tracked_position, &e.smoothed_position,
                      &e.difference_speed, &e.tracked_speed, &e.smoothed_speed})
  {
    *sum = e.count > 0 ? std::sqrt(*sum / static_cast<double>(e.count)) : 0;
  }
}

void addSquare(double& sum, double error)
{
  sum += error * error;
}
}  // namespace

KittiObjectErrors kittiObjectErrors(const KittiDrive& drive,
                                    const std::vector<Pose>& odometry,
                                    const KittiSlamRun& run)
{
  KittiObjectErrors errors;
  for (const auto& [label_id, track] : labelledTracks(drive))
  {
    std::map<int, std::pair<double, Eigen::Vector2d>> before;  // time and place, by track
    for (const auto& [frame, place] : track)
    {
      const auto scan = static_cast<std::size_t>(frame);
      const Pose T_world_odom = drive.truth[scan] * odometry[scan].inverse();
      const Pose T_world_map = drive.truth[scan] * run.trajectory[scan].inverse();
      const TrackedObject* tracked = nearest(run.tracked[scan], T_world_odom, place);
      if (tracked == nullptr)
      {
        continue;
      }
      const Eigen::Vector2d observed = (T_world_odom * tracked->observation.center).head<2>();
      const auto previous = before.find(tracked->id);
      const SmoothedObject* smoothed = smoothedAt(run, scan, tracked->id);
      double speed = 0;
      if (previous != before.end() && smoothed != nullptr &&
          trueSpeed(track, frame, drive.stamps, speed) && speed > slowest)
      {
        const double dt = drive.stamps[scan] - previous->second.first;
        ++errors.count;
        addSquare(errors.observed_position, (observed - place).norm());
        addSquare(errors.tracked_position,
                  ((T_world_odom * tracked->box.center).head<2>() - place).norm());
        addSquare(errors.smoothed_position,
                  ((T_world_map * smoothed->T_map_object.translation()).head<2>() - place).norm());
        addSquare(errors.difference_speed,
                  (observed - previous->second.second).norm() / dt - speed);
        addSquare(errors.tracked_speed, tracked->velocity.head<2>().norm() - speed);
        addSquare(errors.smoothed_speed, smoothed->velocity.head<2>().norm() - speed);
      }
      before[tracked->id] = {drive.stamps[scan], observed};
    }
  }
  takeRoots(errors);
  return errors;
}
}  // namespace dyslam
