// SPDX-License-Identifier: BSD-3-Clause
#include "TrackCompletion.h"

#include <dyslam/base/Angle.h>
#include <dyslam/base/Quantile.h>
#include <dyslam/tracking/BoxFitting.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>

namespace dyslam
{
namespace
{
constexpr double static_speed = 0.5;  // speed below which an object not known to move stands [m/s]
/** Speed above which the course is the heading [m/s]. */
constexpr double least_speed_of_course = 2;     // of vehicles
constexpr double least_speed_of_walking = 0.5;  // of pedestrians and cyclists
constexpr double size_quantile = 0.8;  // quantile of a box's sizes; larger ones are outliers

/** Exchanges the axes of a box so that its heading is within 45 deg of `yaw`. */
void assignAxes(double yaw, Box& box)
{
  const double quarters = std::round((box.yaw - yaw) / (M_PI / 2));
  box.yaw -= quarters * M_PI / 2;
  if (std::fmod(std::abs(quarters), 2) == 1)
  {
    std::swap(box.size.x(), box.size.y());
  }
}

/** Aligns the axes of sightings before the tracker reported the object with the later ones: the
 * longer visible side may have been the width, and the heading was unknown before it moved. */
void alignEarlyBoxes(Sightings& track)
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

/** Sets the heading of driving vehicles to their course; they keep its axes when they slow down. */
void alignWithCourse(const std::vector<TrackState>& smooth, Sightings& track)
{
  std::optional<double> heading;
  std::size_t first = 0;  // first sighting with a course
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    Box& box = track[i].box;
    const Eigen::Vector3d& velocity = smooth[i].velocity;
    if (velocity.head<2>().norm() > least_speed_of_course)
    {
      const double course = std::atan2(velocity.y(), velocity.x());
      assignAxes(course, box);
      box.yaw = course;
      first = heading ? first : i;
      heading = course;
    }
    else if (heading)
    {
      assignAxes(*heading, box);
      heading = box.yaw;
    }
  }
  for (std::size_t i = heading ? first : 0; i-- > 0;)
  {
    assignAxes(track[i + 1].box.yaw, track[i].box);
  }
}

/** Turns vehicles that were never fast enough for alignWithCourse() by half turns, so that they
 * keep their front and move forward rather than backward. */
void findFront(const std::vector<TrackState>& smooth, Sightings& track)
{
  const auto is_fast = [](const TrackState& state)
  { return state.velocity.head<2>().norm() > least_speed_of_course; };
  if (std::any_of(smooth.begin(), smooth.end(), is_fast))
  {
    return;
  }
  double forward = 0;  // distance along the headings, of its square per time
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    double& yaw = track[i].box.yaw;
    if (i > 0 && std::cos(yaw - track[i - 1].box.yaw) < 0)
    {
      yaw = wrapAngle(yaw + M_PI);
    }
    const Eigen::Vector2d velocity = smooth[i].velocity.head<2>();
    forward += velocity.norm() * velocity.dot(Eigen::Vector2d(std::cos(yaw), std::sin(yaw)));
  }
  for (Sighting& s : track)
  {
    s.box.yaw = forward < 0 ? wrapAngle(s.box.yaw + M_PI) : s.box.yaw;
  }
}

/** Sets the heading of pedestrians and cyclists to their course; they keep it while they stand, and
 * have the first one before. Their boxes show no front, and hardly an axis. */
void headAlongCourse(const std::vector<TrackState>& smooth, Sightings& track)
{
  const auto turn = [](double yaw, Box& box)
  {
    assignAxes(yaw, box);
    box.yaw = yaw;
  };
  std::optional<double> heading;
  std::size_t first = 0;  // first sighting with a course
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    const Eigen::Vector3d& velocity = smooth[i].velocity;
    if (velocity.head<2>().norm() > least_speed_of_walking)
    {
      first = heading ? first : i;
      heading = std::atan2(velocity.y(), velocity.x());
    }
    if (heading)
    {
      turn(*heading, track[i].box);
    }
  }
  for (std::size_t i = 0; heading && i < first; ++i)
  {
    turn(track[first].box.yaw, track[i].box);
  }
}

/** Whether the object moves at each sighting: by the tracker from its first "dynamic" on, before
 * that by the speed. */
std::vector<bool> movingOf(const Sightings& track, const std::vector<TrackState>& smooth)
{
  const auto first =
      std::find_if(track.begin(), track.end(), [](const Sighting& s) { return s.dynamic; });
  const auto undecided =
      first == track.end() ? std::ptrdiff_t{0} : std::distance(track.begin(), first);
  std::vector<bool> moving;
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    moving.push_back(static_cast<std::ptrdiff_t>(i) < undecided
                         ? smooth[i].velocity.head<2>().norm() > static_speed
                         : track[i].dynamic);
  }
  return moving;
}

/** Size of the whole object [m], of which single scans see a part. */
Eigen::Vector3d sizeOf(const Sightings& track)
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
    size[k] = quantile(sizes, size_quantile);
  }
  return size;
}

/** Most frequent class of the sightings. */
ObjectClass classOf(const Sightings& track)
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

/** Sets boxes that are much larger than the vehicle, and therefore contain something else, to its
 * size; they count as predicted. \return whether there are any */
bool rejectLargeBoxes(const Eigen::Vector3d& size, Sightings& track)
{
  constexpr double excess = 1;  // in width or length [m]
  bool any = false;
  for (Sighting& s : track)
  {
    if (((s.box.size - size).head<2>().array() > excess).any())
    {
      s.box.size = s.box.size.cwiseMin(size);
      s.observed = false;
      any = true;
    }
  }
  return any;
}

/** Extends the boxes of a vehicle to its size on the hidden sides, so that a vehicle that gradually
 * comes into view does not seem slower or faster. */
void completeVehicle(const Eigen::Vector3d& size, Sightings& track)
{
  for (Sighting& s : track)
  {
    const Eigen::Vector3d sensor(s.sensor.x(), s.sensor.y(), 0);
    s.box.centre -= sensor;
    s.box = completeBox(s.box, size);
    s.box.centre += sensor;
  }
}

/** Enlarges the boxes of pedestrians and cyclists around the centre of the visible part, which is
 * accurate enough for small objects. The top stays in place: feet are removed with the ground. */
void enlarge(const Eigen::Vector3d& size, Sightings& track)
{
  for (Sighting& s : track)
  {
    const double top = s.box.centre.z() + 0.5 * s.box.size.z();
    s.box.size = s.box.size.cwiseMax(size);
    s.box.centre.z() = top - 0.5 * s.box.size.z();
  }
}

std::vector<TrackState> smoothed(const Sightings& track, const TrackSmoothingOptions& options)
{
  std::vector<TrackState> states;
  for (const Sighting& s : track)
  {
    states.push_back({s.time, s.box.centre, s.velocity, s.observed});
  }
  return smoothTrack(states, options);
}

double medianSpeed(const std::vector<TrackState>& states)
{
  std::vector<double> speeds;
  for (const TrackState& state : states)
  {
    speeds.push_back(state.velocity.head<2>().norm());
  }
  return upperMedian(speeds);
}
}  // namespace

void completeAndSmooth(const TrackSmoothingOptions& options, bool complete_boxes, Sightings& track)
{
  alignEarlyBoxes(track);
  ObjectClass object_class = classOf(track);
  if (complete_boxes)
  {
    const std::vector<TrackState> states = smoothed(track, options);
    const double speed = medianSpeed(states);
    object_class = refineClass(object_class, sizeOf(track), speed);
    object_class = refinePerson(object_class, sizeOf(track), speed);
    if (isVehicle(object_class))
    {
      alignWithCourse(states, track);
      const Eigen::Vector3d size = sizeOf(track);
      if (rejectLargeBoxes(size, track))
      {
        alignWithCourse(smoothed(track, options), track);
      }
      findFront(states, track);
      object_class = refineVehicle(object_class, size);
      completeVehicle(size.cwiseMax(leastSize(object_class)), track);
    }
    else
    {
      headAlongCourse(states, track);
      enlarge(leastSize(object_class), track);
    }
  }
  const std::vector<TrackState> states = smoothed(track, options);
  const std::vector<bool> moving = movingOf(track, states);
  for (std::size_t i = 0; i < track.size(); ++i)
  {
    track[i].object_class = object_class;
    track[i].box.centre = states[i].centre;
    track[i].velocity = states[i].velocity;
    track[i].dynamic = moving[i];
  }
}
}  // namespace dyslam
