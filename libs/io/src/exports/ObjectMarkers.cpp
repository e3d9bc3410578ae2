// SPDX-License-Identifier: BSD-3-Clause
#include "ObjectMarkers.h"

#include <dyslam/base/Printable.h>
#include <dyslam/formats/TrajectoryFiles.h>

#include <array>

namespace dyslam
{
namespace
{
constexpr double slowest_arrow = 0.2;  //!< below it the direction is mostly noise [m/s]

RosMarker boxMarker(const MarkedObject& object)
{
  RosMarker marker;
  marker.group = "boxes";
  marker.id = object.id;
  marker.pose = poseFromYpr(object.box.centre.x(), object.box.centre.y(), object.box.centre.z(),
                            object.box.yaw, 0, 0);
  marker.scale = object.box.size;
  marker.colour = object.moves ? std::array<float, 4>{1.0F, 0.45F, 0.1F, 0.5F}
                               : std::array<float, 4>{0.55F, 0.6F, 0.65F, 0.4F};
  return marker;
}

RosMarker nameMarker(const MarkedObject& object)
{
  constexpr double letters = 0.6;  // height [m]
  RosMarker marker;
  marker.group = "names";
  marker.id = object.id;
  marker.shape = RosMarker::Shape::text;
  marker.pose.translation() =
      object.box.centre + (0.5 * object.box.size.z() + letters) * Eigen::Vector3d::UnitZ();
  marker.scale.setConstant(letters);
  marker.text = std::to_string(object.id) + " " + object.type +
                (object.velocity ? formatted(" %.1f m/s", object.velocity->norm()) : "");
  return marker;
}

/** An arrow along the way of one second. \pre the velocity is known */
RosMarker arrowMarker(const MarkedObject& object)
{
  RosMarker marker;
  marker.group = "velocities";
  marker.id = object.id;
  marker.shape = RosMarker::Shape::arrow;
  marker.scale = {0.15, 0.4, 0.5};  // diameters of shaft and head, length of the head
  marker.colour = {1.0F, 0.85F, 0.1F, 1.0F};
  marker.points = {object.box.centre, object.box.centre + *object.velocity};
  return marker;
}
}  // namespace

void addMarkers(const MarkedObject& object, std::vector<RosMarker>& markers)
{
  if (object.moves && object.velocity && object.velocity->norm() > slowest_arrow)
  {
    markers.push_back(arrowMarker(object));
  }
  markers.push_back(boxMarker(object));
  markers.push_back(nameMarker(object));
}
}  // namespace dyslam
