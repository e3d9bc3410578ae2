// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/BoxOverlap.h>
#include <dyslam/tracking/DetectionDeskew.h>

#include <cmath>
#include <stdexcept>

namespace dyslam
{
namespace
{
/** Pose of the vehicle when it swept the direction of `box`, in the vehicle frame at the stamp. */
Pose sweepMotion(const Box& box, const Pose& T_now_next, double interval, const Sweep& sweep)
{
  if (!(interval > 0) || !(sweep.period > 0))
  {
    throw std::invalid_argument("deskewed: interval and period must be positive");
  }
  const double time = sweepTime(std::atan2(box.center.y(), box.center.x()), sweep);
  return expSE3(time / interval * logSE3(T_now_next));
}
}  // namespace

double sweepTime(double azimuth, const Sweep& sweep)
{
  return (sweep.clockwise ? -1 : 1) * azimuth / (2 * M_PI) * sweep.period;
}

Box deskewed(const Box& box, const Pose& T_now_next, double interval, const Sweep& sweep)
{
  return transformed(box, sweepMotion(box, T_now_next, interval, sweep));
}

Box skewed(const Box& box, const Pose& T_now_next, double interval, const Sweep& sweep)
{
  // The box was swept at the azimuth of the result; one iteration from the azimuth of the input is
  // accurate to millimetres.
  const Box first = transformed(box, sweepMotion(box, T_now_next, interval, sweep).inverse());
  return transformed(box, sweepMotion(first, T_now_next, interval, sweep).inverse());
}

void deskewDetections(std::vector<Detection>& detections,
                      const Pose& T_now_next,
                      double interval,
                      const Sweep& sweep)
{
  for (Detection& detection : detections)
  {
    const Pose motion = sweepMotion(detection.box, T_now_next, interval, sweep);
    detection.box = transformed(detection.box, motion);
    Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
    turn.topLeftCorner<3, 3>() = motion.linear();
    detection.covariance = (turn * detection.covariance * turn.transpose()).eval();
  }
}
}  // namespace dyslam
