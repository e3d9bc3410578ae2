// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>
#include <dyslam/formats/RosWriter.h>

#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** An object to draw. */
struct MarkedObject
{
  int id = 0;
  std::string type;                         //!< name of its class
  Box box;                                  //!< map frame
  std::optional<Eigen::Vector3d> velocity;  //!< map frame [m/s]; nothing: not known
  bool moves = false;
};

/** Adds the shapes of an object, map frame: a box, its name and speed and, if it moves, an arrow as
 * long as the way of a second. */
void addMarkers(const MarkedObject& object, std::vector<RosMarker>& markers);
}  // namespace dyslam
