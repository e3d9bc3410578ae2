// SPDX-License-Identifier: BSD-3-Clause
#include "TrackHindsight.h"

#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/Detector.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace dyslam
{
namespace
{
constexpr double static_speed = 0.5;  // below which an object stands before it is reported [m/s]
constexpr double least_speed_of_course = 2;  // above which a vehicle's course is its heading [m/s]
constexpr double length_of_car = 4;          // [m]
constexpr double size_quantile = 0.8;  // of the sizes of a box, the largest of which are outliers

/** An object at one of the scans at which it was reported, map frame. */
struct Sighting
{
  std::size_t scan;  //!< Frame::index
  double stamp;      //!< [s]
  ObjectClass object_class;
  Box box;
  Eigen::Vector3d velocity;  //!< [m/s]
  Eigen::Vector3d sensor;    //!< the lidar's position [m]
  bool observed;
  bool dynamic;
  bool reported;  //!< by the tracker at that time
};

using Track = std::vector<Sighting>;

Sighting sightingOf(const PastObject& report,
                    const PastScan& scan,
                    const Pose& T_vehicle_lidar,
                    const StampedPose& T_map_vehicle)
{
  const Pose T_map_odom = T_map_vehicle.pose * scan.T_odom_vehicle.inverse();
  Sighting s;
  s.scan = scan.index;
  s.stamp = T_map_vehicle.stamp;
  s.object_class = report.object_class;
  s.box = transformed(report.box, T_map_odom);
  s.velocity = T_map_odom.linear() * report.velocity;
  s.sensor = T_map_vehicle.pose * T_vehicle_lidar.translation();
  s.observed = report.observed;
  s.dynamic = report.dynamic;
  s.reported = report.reported;
  return s;
}

/** Names the sides of a box anew, so that its heading is within 45 deg of `yaw`. */
void assignAxes(double yaw, Box& box)
{
  const double quarters = std::round((box.yaw - yaw) / (M_PI / 2));
  box.yaw -= quarters * M_PI / 2;
  if (std::fmod(std::abs(quarters), 2) == 1)
  {
    std::swap(box.size.x(), box.size.y());
  }
}

/** Gives sightings before the tracker reported the object the axes of those after: the longer side
 * that was visible may have been the width, and the heading was not known before it moved. */
void alignEarlyBoxes(Track& track)
{
  const auto first =
      std::find_if(track.begin(), track.end(), [](const Sighting& s) { return s.reported; });
  double yaw = first->box.yaw;
  for (auto s = std::make_reverse_iterator(first); s != track.rend(); ++s)
  {
    assignAxes(yaw, s->box);
    yaw = s->box.yaw;
  }
}

/** Vehicles head where they drive. */
void alignWithCourse(const std::vector<TrackState>& smooth, Track& track)
{
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    const Eigen::Vector3d& velocity = smooth[i].velocity;
    if (velocity.head<2>().norm() > least_speed_of_course)
    {
      const double course = std::atan2(velocity.y(), velocity.x());
      assignAxes(course, track[i].box);
      track[i].box.yaw = course;
    }
  }
}

/** Size of the whole body, of which single scans see a part. */
Eigen::Vector3d sizeOf(const Track& track)
{
  Eigen::Vector3d size;
  for (int k = 0; k < 3; ++k)
  {
    std::vector<double> sizes;
    for (const Sighting& s : track)
    {
      if (s.reported)
      {
        sizes.push_back(s.box.size[k]);
      }
    }
    const auto nth = sizes.begin() + static_cast<std::ptrdiff_t>(
                                         size_quantile * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), nth, sizes.end());
    size[k] = *nth;
  }
  return size;
}

/** The class of most sightings. */
ObjectClass classOf(const Track& track)
{
  std::map<ObjectClass, int> counts;
  for (const Sighting& s : track)
  {
    counts[s.object_class] += s.reported ? 1 : 0;
  }
  const auto most =
      std::max_element(counts.begin(), counts.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  return most->first;
}

/** Gives the boxes of a vehicle, others being small enough to be seen whole, their size as if the
 * hidden sides had been seen, so that a body which comes into view by and by does not seem slower
 * or faster than it is. */
void complete(const Eigen::Vector3d& size, Track& track)
{
  for (Sighting& s : track)
  {
    const Eigen::Vector3d sensor(s.sensor.x(), s.sensor.y(), 0);
    s.box.center -= sensor;
    s.box = completeBox(s.box, size);
    s.box.center += sensor;
  }
}

std::vector<TrackState> smoothed(const Track& track, const TrackSmoothingOptions& options)
{
  std::vector<TrackState> states;
  for (const Sighting& s : track)
  {
    states.push_back({s.stamp, s.box.center, s.velocity, s.observed});
  }
  return smoothTrack(states, options);
}

/** Smooths the track of a vehicle of which single scans see a part. */
std::vector<TrackState> smoothedVehicle(ObjectClass object_class,
                                        const TrackSmoothingOptions& options,
                                        Track& track)
{
  alignWithCourse(smoothed(track, options), track);
  Eigen::Vector3d size = sizeOf(track);
  if (object_class == ObjectClass::car || object_class == ObjectClass::van)
  {
    size.x() = std::max(size.x(), length_of_car);  // maybe only its front or rear was ever seen
  }
  complete(size, track);
  return smoothed(track, options);
}

SmoothedObject smoothedObject(int id,
                              ObjectClass object_class,
                              const Sighting& sighting,
                              const TrackState& smooth)
{
  SmoothedObject object;
  object.id = id;
  object.scan = sighting.scan;
  object.stamp = sighting.stamp;
  object.T_map_object = Eigen::Translation3d(smooth.center) *
                        Eigen::AngleAxisd(sighting.box.yaw, Eigen::Vector3d::UnitZ());
  object.velocity = smooth.velocity;
  object.moving = sighting.reported ? sighting.dynamic : smooth.velocity.norm() > static_speed;
  object.size = sighting.box.size;
  object.object_class = object_class;
  return object;
}
}  // namespace

std::vector<SmoothedObject> smoothReported(const RunHistory& history,
                                           const Trajectory& trajectory,
                                           const TrackSmoothingOptions& options,
                                           bool complete_boxes)
{
  std::vector<SmoothedObject> objects;
  if (options.window <= 0)
  {
    return objects;
  }
  std::map<int, Track> tracks;
  history.forEachReported(
      [&](const PastObject& report)
      {
        const PastScan& scan = history.scans()[report.scan];
        const StampedPose& pose = trajectory[report.scan];
        Track& track = tracks[report.id];
        if (track.empty() || pose.stamp > track.back().stamp)
        {
          track.push_back(sightingOf(report, scan, history.mounts()[scan.mount], pose));
        }
      });
  for (auto& [id, track] : tracks)
  {
    if (std::none_of(track.begin(), track.end(), [](const Sighting& s) { return s.reported; }))
    {
      continue;
    }
    const ObjectClass object_class = classOf(track);
    alignEarlyBoxes(track);
    const std::vector<TrackState> states = complete_boxes && isVehicle(object_class)
                                               ? smoothedVehicle(object_class, options, track)
                                               : smoothed(track, options);
    for (std::size_t i = 0; i < states.size(); ++i)
    {
      objects.push_back(smoothedObject(id, object_class, track[i], states[i]));
    }
  }
  std::sort(objects.begin(), objects.end(),
            [](const SmoothedObject& a, const SmoothedObject& b)
            { return std::tie(a.scan, a.id) < std::tie(b.scan, b.id); });
  return objects;
}
}  // namespace dyslam
