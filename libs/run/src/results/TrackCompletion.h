// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/tracking/TrackSmoother.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace dyslam
{
/** A tracked object at one of the scans at which it counts, map frame. */
struct Sighting
{
  std::size_t scan;  //!< Frame::index
  double stamp;      //!< UNIX time [s]
  double time;       //!< Frame::time() [s]
  ObjectClass object_class;
  Box box;
  Eigen::Vector3d velocity;  //!< map frame [m/s]
  Eigen::Vector3d sensor;    //!< position of the lidar, map frame [m]
  bool observed;
  bool dynamic;
  bool reported;  //!< TrackedObject::reported at that scan
};

/** Sightings of one object in order of time, at least one of them reported. */
using Sightings = std::vector<Sighting>;

/** Sets class, box, velocity and motion of every sighting to the smoothed ones of the object.
 * \param complete_boxes the boxes are those of visible parts of objects, to be completed */
void completeAndSmooth(const TrackSmoothingOptions& options, bool complete_boxes, Sightings& track);
}  // namespace dyslam
