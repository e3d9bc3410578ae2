// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace dyslam
{
enum class ObjectClass
{
  unknown,
  car,
  van,
  truck,
  bus,
  motorcyclist,
  cyclist,
  pedestrian
};

/** Name as KITTI writes it ("Car", "Pedestrian", ...; "Misc" for unknown). */
[[nodiscard]] std::string toString(ObjectClass object_class);
/** Class with this name, in upper or lower case; unknown for other names. */
[[nodiscard]] ObjectClass objectClassFromString(const std::string& name);
/** Whether a class is car, van, truck or bus. */
[[nodiscard]] bool isVehicle(ObjectClass object_class);

/** An upright box; its frame is documented where it is used. */
struct Box
{
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  //!< centre of the volume [m]
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    //!< length (along heading), width, height [m]
  double yaw = 0;                                    //!< heading about +z from +x [rad]
};

/** One object seen in one scan. */
struct Detection
{
  Box box;  //!< vehicle frame at the scan's stamp
  ObjectClass object_class = ObjectClass::unknown;
  double score = 1;  //!< detector's confidence; its scale is the detector's
  /** Covariance of the box's x, y, z [m^2], yaw [rad^2], vehicle frame at the scan's stamp. */
  Eigen::Matrix4d covariance = 0.1 * Eigen::Matrix4d::Identity();
  std::vector<std::uint32_t> points;  //!< positions in Frame::cloud; empty if not known
  bool predicted = false;             //!< most of its points are Frame::moving_by_prediction
  bool external = false;  //!< a box of another detector: the whole object, which need not move
};

/** The state of one tracked object after a scan. */
struct TrackedObject
{
  int id = -1;
  Box box;  //!< odometry frame
  ObjectClass object_class = ObjectClass::unknown;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  //!< odometry frame [m/s] (Eq. 5)
  /** Covariance of the box's x, y, z [m^2], yaw [rad^2], odometry frame. */
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();
  bool confirmed = false;  //!< seen often enough to be reported
  bool dynamic = false;    //!< speed over the threshold, with hysteresis
  bool reported = false;   //!< shown and written: confirmed and recently observed
  bool observed = false;   //!< matched to a detection of this scan
  int detection = -1;      //!< which one, in Frame::detections
  int age = 0;             //!< scans since birth
  /** Mean score of the track's detections, on the detector's scale; recent ones weigh more
   * (score_memory), and zeros are added (score_prior, and miss_prior for each miss). */
  double score = 0;
  /** Box of the matched detection, odometry frame; valid where `observed`. Length and width are
   * assigned as in the track's box, hidden extents of a cluster are completed to the track's size,
   * and the heading is within 90 deg of the track's. */
  Box observation;
  /** Covariance of x, y, z [m^2], yaw [rad^2] of `observation`, odometry frame; valid where
   * `observed`. */
  Eigen::Matrix4d observation_covariance = Eigen::Matrix4d::Identity();
};

/** A labelled box at one frame of a recording: ground truth or an exported track. */
struct LabelledBox
{
  int frame = 0;
  int id = -1;
  ObjectClass object_class = ObjectClass::unknown;
  std::string type;  //!< class name in the spelling of the file
  Box box;           //!< in the frame that the reader documents
  double score = 1;  //!< confidence, on the scale of its detector or tracker; 1 in files without it
  /** Truncation by the border of the image, KITTI tracking's code: 0 none, 1 partly, 2 largely; -1
   * in areas DontCare. */
  int truncated = 0;
  /** Occlusion, KITTI's code: 0 fully visible, 1 partly, 2 largely occluded, 3 unknown; -1 in areas
   * DontCare. */
  int occluded = 0;
  Eigen::Vector4d image_box = Eigen::Vector4d::Zero();  //!< left, top, right, bottom [px]
};
}  // namespace dyslam
