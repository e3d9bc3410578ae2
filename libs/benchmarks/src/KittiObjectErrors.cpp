// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/benchmarks/DetectionDeskew.h>
#include <dyslam/benchmarks/KittiSlam.h>

#include <cmath>
#include <limits>
#include <map>

namespace dyslam
{
namespace
{
constexpr int half_window = 5;      // scans to each side that give the true speed at a scan
constexpr double slowest = 1;       // least speed of the evaluated vehicles [m/s]
constexpr double max_distance = 2;  // largest distance of an observation from its label [m]

using Track = std::map<int, Eigen::Vector2d>;  // positions in the plane by scan

bool isEvaluated(ObjectClass object_class)
{
  return object_class == ObjectClass::car || object_class == ObjectClass::van ||
         object_class == ObjectClass::truck;
}

/** Deskewed positions of the labels in the world frame; like the detections, labels are from scans
 * that are not deskewed. */
std::map<int, Track> labelledTracks(const KittiDrive& drive)
{
  std::map<int, Track> tracks;
  for (const LabelledBox& label : drive.labels)
  {
    const auto scan = static_cast<std::size_t>(label.frame);
    if (label.frame < 1 || scan >= drive.truth.size() || !isEvaluated(label.object_class))
    {
      continue;
    }
    const double interval = drive.stamps[scan] - drive.stamps[scan - 1];
    const Box box = deskewed(label.box, drive.truth[scan - 1].inverse() * drive.truth[scan],
                             interval, interval);
    tracks[label.id][label.frame] = (drive.truth[scan] * box.centre).head<2>();
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

/** The observed track nearest to a position in the world; null if none is near. \param T_world_odom
 * at the scan */
const TrackedObject* nearest(const std::vector<TrackedObject>& tracked,
                             const Pose& T_world_odom,
                             const Eigen::Vector2d& place)
{
  const TrackedObject* best = nullptr;
  double smallest = max_distance;
  for (const TrackedObject& object : tracked)
  {
    const double distance = ((T_world_odom * object.observation.centre).head<2>() - place).norm();
    if (object.observed && distance < smallest)
    {
      smallest = distance;
      best = &object;
    }
  }
  return best;
}

/** Converts sums of squares to root mean squares; NaN of no vehicle. */
void takeRoots(KittiObjectErrors& e)
{
  for (double* sum : {&e.observed_position, &e.tracked_position, &e.smoothed_position,
                      &e.difference_speed, &e.tracked_speed, &e.smoothed_speed})
  {
    *sum = e.count > 0 ? std::sqrt(*sum / static_cast<double>(e.count))
                       : std::numeric_limits<double>::quiet_NaN();
  }
}

void addSquare(double& sum, double error)
{
  sum += error * error;
}

/** A labelled vehicle in one scan and the track that observed it, in the world. */
struct ObservedVehicle
{
  int label = -1;
  int frame = 0;
  Eigen::Vector2d place;        // position of the label [m]
  Eigen::Vector2d observed;     // position of the detection [m]
  Eigen::Vector2d tracked;      // filtered position [m]
  double tracked_speed = 0;     // speed by the tracker [m/s]
  double difference_speed = 0;  // speed from the previous to this observation of the track [m/s]
  Eigen::Vector2d smoothed;
  double smoothed_speed = 0;
};

/** Observations of labelled vehicles, except the first one of each track. */
std::vector<ObservedVehicle> observedVehicles(const KittiDrive& drive,
                                              const std::map<int, Track>& labels,
                                              const std::vector<Pose>& odometry,
                                              const KittiSlamRun& run)
{
  std::vector<ObservedVehicle> vehicles;
  for (const auto& [label, track] : labels)
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
      const Eigen::Vector2d observed = (T_world_odom * tracked->observation.centre).head<2>();
      const auto previous = before.find(tracked->id);
      const SmoothedObject* smoothed = findSmoothed(run.objects, scan, tracked->id);
      if (previous != before.end() && smoothed != nullptr)
      {
        const double dt = drive.stamps[scan] - previous->second.first;
        vehicles.push_back(
            {label, frame, place, observed, (T_world_odom * tracked->box.centre).head<2>(),
             tracked->velocity.head<2>().norm(), (observed - previous->second.second).norm() / dt,
             (T_world_map * smoothed->T_map_object.translation()).head<2>(),
             smoothed->velocity.head<2>().norm()});
      }
      before[tracked->id] = {drive.stamps[scan], observed};
    }
  }
  return vehicles;
}
}  // namespace

KittiObjectErrors kittiObjectErrors(const KittiDrive& drive,
                                    const std::vector<Pose>& odometry,
                                    const KittiSlamRun& run)
{
  KittiObjectErrors errors;
  const std::map<int, Track> labels = labelledTracks(drive);
  for (const ObservedVehicle& vehicle : observedVehicles(drive, labels, odometry, run))
  {
    double speed = 0;
    if (!trueSpeed(labels.at(vehicle.label), vehicle.frame, drive.stamps, speed) ||
        speed <= slowest)
    {
      continue;
    }
    ++errors.count;
    addSquare(errors.observed_position, (vehicle.observed - vehicle.place).norm());
    addSquare(errors.tracked_position, (vehicle.tracked - vehicle.place).norm());
    addSquare(errors.smoothed_position, (vehicle.smoothed - vehicle.place).norm());
    addSquare(errors.difference_speed, vehicle.difference_speed - speed);
    addSquare(errors.tracked_speed, vehicle.tracked_speed - speed);
    addSquare(errors.smoothed_speed, vehicle.smoothed_speed - speed);
  }
  takeRoots(errors);
  return errors;
}

std::map<int, KittiVehicleSpeeds> kittiVehicleSpeeds(const KittiDrive& drive,
                                                     const std::vector<Pose>& odometry,
                                                     const KittiSlamRun& run)
{
  std::map<int, KittiVehicleSpeeds> speeds;
  for (const ObservedVehicle& v : observedVehicles(drive, labelledTracks(drive), odometry, run))
  {
    const double time = drive.stamps[static_cast<std::size_t>(v.frame)] - drive.stamps.front();
    KittiVehicleSpeeds& vehicle = speeds[v.label];
    vehicle.tracked.emplace_back(time, v.tracked_speed);
    vehicle.smoothed.emplace_back(time, v.smoothed_speed);
  }
  return speeds;
}
}  // namespace dyslam
