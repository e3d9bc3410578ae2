// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Pose.h>

#include <Eigen/Core>
#include <cmath>

namespace dyslam
{
/** How a spinning sensor without per-point times sweeps its revolution. */
struct SweepModel
{
  /** -1: clockwise seen from above (azimuth falls with time), +1: counter-clockwise. */
  int direction = -1;
  /** Azimuth at which the sweep begins and ends, from +x towards +y [rad]. The default, straight
   * behind, is that of the HDL-64E scans of KITTI: straight ahead is at half the sweep. */
  double start_azimuth = M_PI;
};

/** Share of the revolution, in [0, 1), at which a sensor of this model looks towards `p` (lidar
 * frame). Accurate to 3e-5 of a revolution. */
[[nodiscard]] float sweepFraction(const Eigen::Vector3f& p, const SweepModel& model);

/** Transforms points measured at different times of a sweep to the body frame at one reference
 * time.
 *
 * The body moves with constant velocity (along a screw) by `T_start_end`, which takes points of the
 * body frame at fraction 1 of the sweep to that at fraction 0. toReference() takes a point in the
 * body frame at its fraction to the body frame at fraction `reference`. Fractions outside [0, 1]
 * extrapolate.
 */
class SweepMotion
{
 public:
  /** \param reference fraction of the sweep whose body frame the results are in: 0 the start. */
  SweepMotion(const Pose& T_start_end, double reference);

  [[nodiscard]] Eigen::Vector3f toReference(const Eigen::Vector3f& p, float fraction) const
  {
    // exp(s * twist) by its series; at 0.5 rad per sweep the error is 1e-5 of the range.
    const float s = fraction - reference_;
    const float s2 = s * s;
    const float a = s * (1.0F - s2 * angle2_ * (1.0F / 6.0F));
    const float b = s2 * (0.5F - s2 * angle2_ * (1.0F / 24.0F));
    const Eigen::Vector3f wp = rotation_.cross(p);
    const Eigen::Vector3f wwp = rotation_.cross(wp);
    return p + a * wp + b * wwp + s * translation_ + b * w_translation_ +
           (s * s2 * (1.0F / 6.0F)) * ww_translation_;
  }

 private:
  float reference_;
  Eigen::Vector3f rotation_;
  Eigen::Vector3f translation_;
  Eigen::Vector3f w_translation_;
  Eigen::Vector3f ww_translation_;
  float angle2_;
};

/** Factor that converts phases in units of `from` seconds to units of `to` seconds; 1 if either is
 * unknown (0 or less). */
[[nodiscard]] inline float phaseScale(double from, double to)
{
  return from > 0 && to > 0 ? static_cast<float>(from / to) : 1.0F;
}
}  // namespace dyslam
