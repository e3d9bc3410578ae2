// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Objects.h>

#include <Eigen/Core>
#include <cmath>

namespace dyslam
{
/** The inside of an upright box, for many points in the frame of the box. \tparam Scalar float or
 * double: of the points and the arithmetic */
template <typename Scalar>
class BoxInterior
{
 public:
  using Point = Eigen::Matrix<Scalar, 3, 1>;

  /** \param margin by which the box is widened to each side: along, across and vertical [m] */
  BoxInterior(const Box& box, const Point& margin)
      : centre_(box.centre.template cast<Scalar>()),
        half_(Scalar(0.5) * box.size.template cast<Scalar>() + margin),
        bottom_(-half_.z()),
        height_(static_cast<Scalar>(box.size.z())),
        reach_(half_.template head<2>().squaredNorm()),
        cosine_(static_cast<Scalar>(std::cos(box.yaw))),
        sine_(static_cast<Scalar>(std::sin(box.yaw)))
  {
  }

  /** Without the ground that the object stands on. \param clearance from the bottom of the box,
   * without margin, up [m] */
  [[nodiscard]] BoxInterior aboveGround(Scalar clearance) const
  {
    BoxInterior upper = *this;
    upper.bottom_ = clearance - Scalar(0.5) * height_;
    return upper;
  }

  /** Points on the surface are outside, as those with NaN. */
  [[nodiscard]] bool contains(const Point& point) const
  {
    const Point p = point - centre_;
    return p.template head<2>().squaredNorm() < reach_ && p.z() > bottom_ && p.z() < half_.z() &&
           std::abs(cosine_ * p.x() + sine_ * p.y()) < half_.x() &&
           std::abs(cosine_ * p.y() - sine_ * p.x()) < half_.y();
  }

 private:
  Point centre_;
  Point half_;     //!< half the size, with margins [m]
  Scalar bottom_;  //!< from the centre [m]
  Scalar height_;  //!< of the box without margins [m]
  Scalar reach_;   //!< horizontal distance of the corners, squared [m^2]
  Scalar cosine_;  //!< of the yaw
  Scalar sine_;    //!< of the yaw
};
}  // namespace dyslam
