// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>
#include <dyslam/train/RandomDraws.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace dyslam
{
/** A box or an ellipsoid, part of a synthetic body, axes along the body's. */
struct BodyPart
{
  Eigen::Vector3f centre;  //!< body frame: x ahead, z up from the ground [m]
  Eigen::Vector3f half;    //!< half lengths along the axes [m]
  bool round = false;      //!< an ellipsoid instead of a box
};

enum class BodyKind
{
  car,
  van,
  truck,
  pedestrian,
  cyclist,
  random  //!< some boxes and ellipsoids, of no class
};

/** A synthetic body for ray casting. */
struct CastBody
{
  BodyKind kind = BodyKind::random;
  std::vector<BodyPart> parts;

  float radius = 0;  //!< radius around the origin that holds the body, seen from above [m]
  Eigen::AlignedBox3f bounds;  //!< bounding box of all parts, body frame [m]
  /** Whether a position lies within `margin` [m] of the bounds, seen from above. \param p body
   * frame [m] */
  [[nodiscard]] bool covers(const Eigen::Vector2f& p, float margin) const;
};

/** A body of given parts; computes its radius and bounds. */
[[nodiscard]] CastBody assembleBody(BodyKind kind, std::vector<BodyPart> parts);

/** A body of a kind, with random sizes. */
[[nodiscard]] CastBody makeBody(BodyKind kind, RandomDraws& draws);

/** Casts the rays of a scan against a body: a point whose ray hits the body first is moved onto the
 * body. So the body occludes what is behind it and is sampled as by the sensor. A body around the
 * sensor or right beside it is not hit.
 *
 * \param T_sensor_body upright pose of the body, its origin on the ground
 * \param[in,out] points sensor frame, sensor at the origin [m] \return indices of the points that
 * now lie on the body
 */
std::vector<std::uint32_t> castBody(const CastBody& body,
                                    const Pose& T_sensor_body,
                                    float range_noise,
                                    RandomDraws& draws,
                                    std::vector<Eigen::Vector3f>& points);
}  // namespace dyslam
